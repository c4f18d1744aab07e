#!/usr/bin/env bash
# Every policy on both benchmarks, protocol full, side by side on one machine; freezes lists that are not there yet.
#
#     bash benchmarks/all_policies.sh OUT AUTOBENCH_BANK CRAFTBENCH_BANK [IMPL]
#
# PYTHON names the interpreter, SERIAL=1 runs one after the other, POLICIES names others than those of the paper's table,
# MORE holds further options (`--scenes 1`, `--env-name Go2Nav`). VERSION=_v2 takes the lists of version 2 of both.
# OUT gets lists/NAME.json and NAME-POLICY/report.md, report.json, episodes.csv, scenes.csv; a failed run leaves its log.
set -u
out=$1 impl=${4:-auto}
declare -A banks=([autobench]=$2 [craftbench]=$3)
# The paper has ten scenes, the release twelve; docs/decisions/benchmarks.md says why these two are extra.
extra="03_residential_street_dual_sidewalks_clean 12_courtyard_plaza_central_fountain"
export XLA_PYTHON_CLIENT_PREALLOCATE=false PYTHONPATH=${PYTHONPATH:-$PWD}
mkdir -p "$out/lists"
pids=()
# shellcheck disable=SC2086
one() { # benchmark, policy, folder
  ${PYTHON:-python} -m urbanverse_mjx.cli.main benchmark "$out/lists/$1.json" --bank "${banks[$1]}" --policy "$2" --protocol full \
    --impl "$impl" --at-once 768 --no-pictures --quiet ${MORE:-} --out "$out/$1-$3" > "$out/$1-$3.log" 2>&1 \
    && rm "$out/$1-$3.log"
}
for set in autobench craftbench; do
  name=$set${VERSION:-}
  banks[$name]=${banks[$set]}
  [ -s "${banks[$name]}" ] || continue
  if [ -s "benchmarks/protocols/$name.json" ]; then
    cp "benchmarks/protocols/$name.json" "$out/lists/"
  else
    [ "$set" = craftbench ] && more="--extra $extra" || more=""
    # shellcheck disable=SC2086
    ${PYTHON:-python} -m benchmarks.freeze "$name" --bank "${banks[$name]}" --out "$out/lists" $more || continue
  fi
  for policy in ${POLICIES:-planner zero random go_to_goal benchmarks/policies/coco_paper}; do
    one "$name" "$policy" "$(basename "$policy")" &
    pids+=($!)
    [ -n "${SERIAL:-}" ] && wait $!
  done
done
for pid in "${pids[@]}"; do wait "$pid" 2> /dev/null; done
grep -H -E "^\| (policy|planner|zero|random|go_to_goal|coco_paper|coco_best|go2_best) " "$out"/*/report.md
