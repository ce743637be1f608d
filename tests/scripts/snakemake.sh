#!/usr/bin/env bash
# The exported workflow against one run: two jobs at a time, one of them killed at random, then the reports and tidy data byte for byte.
#
#   tests/scripts/snakemake.sh [RAW ...]          (default: raw/ of the repository)
#
# PIPELINE names the program (default: target/release/pipeline), VENV a virtual environment with Snakemake (default: a new one in the scratch
# directory), SEED which job is killed.
set -euo pipefail
repository=$(cd "$(dirname "$0")/../.." && pwd)
program=$(realpath "${PIPELINE:-$repository/target/release/pipeline}")
scratch=$(mktemp -d)
trap 'rm -rf "$scratch"' EXIT
RANDOM=${SEED:-1}

venv=${VENV:-$scratch/venv}
if [ ! -x "$venv/bin/snakemake" ]; then
    python3 -m venv "$venv"
    "$venv/bin/pip" install --quiet snakemake
fi
raw=()
for folder in "${@:-$repository/raw}"; do
    raw+=(--raw "$(realpath "$folder")")
done

cd "$scratch"
echo "one run"
time "$program" run "${raw[@]}" --derived alone/derived --reports alone/reports > alone.txt

"$program" export snakemake "${raw[@]}" --derived shared/derived --reports shared/reports > Snakefile
snakemake() {
    "$venv/bin/snakemake" --cores 2 --config pipeline="$program" "$@" >> jobs.txt 2>> snakemake.txt
}

# In a process group of its own, in which a job is looked for and killed by its id.
echo "the workflow, killed"
set -m
snakemake &
group=$!
set +m
sleep $((5 + RANDOM % 30))
killed=
while [ -z "$killed" ] && kill -0 "$group" 2> /dev/null; do
    job=$(pgrep -g "$group" -x "$(basename "$program")" | head -n 1 || true)
    if [ -n "$job" ] && what=$(tr '\0' ' ' < "/proc/$job/cmdline") && kill -9 "$job" 2> /dev/null; then
        killed=$what
    fi
done
if wait "$group"; then
    echo "no job was killed: the workflow was too quick"
    exit 1
fi
echo "killed: $killed"

echo "the workflow, once more"
time snakemake
tail -n 1 jobs.txt; grep -c "computed" jobs.txt
diff -r alone/reports shared/reports
diff -r --exclude cache alone/derived shared/derived
files=$(find shared/reports shared/derived -type f -not -path '*/cache/*' | wc -l)
"$program" status "${raw[@]}" --derived shared/derived --reports shared/reports
echo "equal byte for byte: $files files"
