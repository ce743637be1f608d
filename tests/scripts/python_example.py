import json

import duckdb
import pandas
import polars

path = "derived/rows.parquet"

units = json.loads(polars.read_parquet_metadata(path)["units"])
assert units["force_n"] == "N" and units["contraction_rel"] == "1"

rows = pandas.read_parquet(path)
fitted = rows[(rows.excluded == 0) & rows.force_n.notna()]  # readings of torque have no force
strongest = fitted.groupby("specimen").force_n.max()
print(strongest.to_string(), units["force_n"])

same = (
    polars.scan_parquet(path)
    .filter(polars.col("excluded") == 0, polars.col("force_n").is_not_null())
    .group_by("specimen")
    .agg(polars.col("force_n").max())
    .sort("specimen")
    .collect()
)
assert same["force_n"].to_list() == strongest.to_list()

query = f"select specimen, max(force_n) from '{path}' where excluded = 0 and force_n is not null group by all order by all"
assert duckdb.sql(query).fetchall() == list(strongest.items())

query = "select distinct session from read_parquet('derived/sessions/*/rows.parquet', union_by_name = true)"
print(len(duckdb.sql(query).fetchall()), "sessions")
