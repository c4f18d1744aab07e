#!/usr/bin/env bash
# Builds the streets of Go2Nav's shipped policy, trains it anew on one GPU for a given time, and judges it.
#
#     bash benchmarks/go2_nav.sh streets BANK              16 cousins, 64 and 16 benchmark streets, the two test streets
#     bash benchmarks/go2_nav.sh train BANK OUT [SECONDS]  at most so long (500), then the newest checkpoint's actor in OUT/policy
#     bash benchmarks/go2_nav.sh judge BANK OUT            OUT/policy on unseen streets, by the Go2 and by COCO
#
# PYTHON names the interpreter; START the policy whose networks to begin with ("" = from nothing); MORE further options of
# `train`. OUT gets policy/ (2.8 MB), log.jsonl, train.log and a line of JSON per evaluation.
set -euo pipefail
what=$1 bank=$2
export PYTHONPATH=${PYTHONPATH:-$PWD} XLA_PYTHON_CLIENT_PREALLOCATE=${XLA_PYTHON_CLIENT_PREALLOCATE:-false}
python=${PYTHON:-python}
cli() { "$python" -m urbanverse_mjx.cli.main "$@"; }

streets() {
  local work parts=() pids=()
  work=$(mktemp -d)
  for first in 0 8 16 24 32 40 48 56 144 152; do
    parts+=("$work/bench$first.npz")
    "$python" -m benchmarks.bank --layouts 8 --first "$first" --out "$work/bench$first.npz" > /dev/null &
    pids+=($!)
  done
  cli scene bank scenes/{residential_bins,commercial_cafes,construction_narrow,tourist_scooters}/graph.json \
    --cousins 4 --split train --out "$work/cousins.npz"
  cli scene bank scenes/{commercial_bike_lane,park_edge}/graph.json --split test --out "$work/test.npz"
  for pid in "${pids[@]}"; do wait "$pid"; done
  cli scene join "$work/cousins.npz" "$work/test.npz" "${parts[@]}" --out "$bank" \
    --split "held_out=bench_s0_14[4-9]" "held_out=bench_s0_15?"
  rm -r "$work"
}

train() {
  local out=$1 seconds=$2 start=${START-benchmarks/policies/coco_paper}
  mkdir -p "$out"
  # Stopped by time: the checkpoints before stay.
  # shellcheck disable=SC2086
  URBANVERSE_BANK=$bank timeout "$seconds" "$python" -m urbanverse_mjx.cli.main train --env-name Go2Nav --preset paper \
    --num-envs 1024 --num-timesteps 29491200 --ppo-overrides '{"num_checkpoints":100}' ${start:+--start-from "$start"} \
    --num-episodes 0 --quiet --logdir "$out/runs" ${MORE:-} > "$out/train.log" 2>&1 || [ $? -eq 124 ]
  cli export-policy "$out"/runs/* --out "$out/policy"
  cp "$out"/runs/*/log.jsonl "$out/"
}

judge() {
  local out=$1 scenes
  for robot in Go2Nav CocoNav; do
    for scenes in held_out test; do
      URBANVERSE_BANK=$bank cli evaluate "$out/policy" --scenes "$scenes" --num-episodes 200 --env-name "$robot" \
        --no-video --quiet --out "$out/$robot-$scenes" > "$out/$robot-$scenes.json"
      rm -r "${out:?}/$robot-$scenes"
    done
  done
}

case $what in
  streets) streets ;;
  train) train "$3" "${4:-500}" ;;
  judge) judge "$3" ;;
  *) echo "needed streets, train or judge, found $what" >&2 && exit 2 ;;
esac
