# Written by `pipeline export snakemake`. Write it again when sessions come or go or change their campaign, diameter or logs.
#
# One machine:  snakemake --cores 8
# A cluster:    snakemake --executor slurm --jobs 200 --set-threads diagnose=8
#
# A job brings one unit of one stage up to date in the cache, which all machines share, and leaves a stamp there; `normalize` goes with the two stages
# before it. The rule `report` is an ordinary run, which finds all results in the cache. The program is `pipeline` on the path, or what
# `--config pipeline=...` says.
import shlex

PROGRAM = config.get("pipeline", "pipeline")
PLACES = shlex.join(@PLACES)
STAMPS = @STAMPS
UNITS = @UNITS


rule report:
    input: [f"{STAMPS}/{stage}/{unit}" for stage in UNITS for unit in UNITS[stage]]
    output: @SUMMARY
    threads: @THREADS
    shell: "{PROGRAM} run {PLACES} --jobs {threads}"

@RULES
