#!/usr/bin/env bash
# Trains and scores the policies of the table's rows `teacher`, `best` and, from seed SHIP's, the Go2's, on one GPU.
#
#     urbanverse scene library procedural places validation craftbench autobench
#     bash benchmarks/best_policies.sh BANKS OUT
#
# BANKS holds procedural/bank.npz and so on, as `urbanverse scene library` builds them in its cache. The last 8 scenes of
# procedural, the last 9 of places and all of validation choose between checkpoints; OUT gets a folder for each training.
# SEEDS and SHIP name seeds; PYTHON the interpreter; TEACHER_STEPS (env-steps), IMITATION, PPO, GO2 (iterations) lengths;
# MORE further options of benchmarks.generalise. A training that is done is not done again.
set -eu
banks=$1 out=$2
seeds=${SEEDS:-0 1 2} ship=${SHIP:-1}
export XLA_PYTHON_CLIENT_PREALLOCATE=false PYTHONPATH=${PYTHONPATH:-$PWD}
# shellcheck disable=SC2086
generalise() { # role, folder, options
  role=$1 folder=$2
  shift 2
  [ -s "$folder/result.json" ] || ${PYTHON:-python} -m benchmarks.generalise "$role" --no-map \
    --train "$banks/procedural/bank.npz" "$banks/places/bank.npz" --holdout ${HOLDOUT:-8 9} \
    --test "$banks/validation/bank.npz" "$banks/craftbench/bank.npz" "$banks/autobench/bank.npz" --out "$folder" "$@" ${MORE:-}
}
row() { # folder, agent, policy, robot, seed
  ${PYTHON:-python} -m benchmarks.results --add "$1/result.json" --agent "$2" --policy "$3" --robot "$4" --seed "$5"
}
for seed in $seeds; do
  generalise teacher "$out/teacher$seed" --seed "$seed" --steps "${TEACHER_STEPS:-12000000}" --seconds 3000 --checkpoints 40
  row "$out/teacher$seed" teacher teacher COCO "$seed"
  generalise student "$out/coco$seed" --seed "$seed" --teacher "$out/teacher$seed" --memory 256 --covered \
    --steps "${IMITATION:-320}" --seconds 3000 --validate-every 80 \
    --finetune-steps "${PPO:-200}" --finetune-seconds 3000 --set-finetune imitation=0.0 final_imitation=0.0
  row "$out/coco$seed" student student COCO "$seed"
  row "$out/coco$seed" finetuned best COCO "$seed"
  row "$out/coco$seed" covered "best, camera covered" COCO "$seed"
done
# The Go2 begins with COCO's parameters and imitates COCO's teacher on the states that the Go2 visits.
generalise student "$out/go2" --environment Go2Nav --seed "$ship" --teacher "$out/teacher$ship" --memory 256 --covered \
  --start "$out/coco$ship/finetuned" --steps "${GO2:-100}" --seconds 3000 --validate-every 20
row "$out/go2" student go2_best Go2 "$ship"
