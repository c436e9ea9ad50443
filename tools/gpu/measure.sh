#!/usr/bin/env bash
# All that a GPU is asked for, in one run: is its kernel right, and how fast is it?
#
#   measure.sh OUT TRIMRAY [TEST_BINARY...] [-- FILE...]
#
# OUT is a folder for what is measured. TEST_BINARYs are built by `cargo test --release --no-run --test equivalence`; they compare the GPU with the CPU.
# FILEs are measured beside the fixtures. Nothing is compiled here, so that the machine with the GPU needs neither Rust nor a network; what is built elsewhere
# has to be built for its processor, with RUSTFLAGS="-C target-cpu=x86-64-v3".
# Everything that fails is told, and the rest goes on. RUNS and WARM_UPS (15 and 5, as in Sloup and Havran 2021), PRIMARY, pixels and rays through each of
# them ("1920,1080,4"), RANDOM_RAYS, random rays, and PICTURES, the files of which pictures are timed too, make it shorter.
set -uo pipefail
out=${1:?a folder for what is measured}
trimray=${2:?the trimray binary}
shift 2
tests=()
while [ $# -gt 0 ] && [ "$1" != -- ]; do
    tests+=("$1")
    shift
done
[ $# -gt 0 ] && shift
cd "$(dirname "$0")/../.." || exit 1
runs=${RUNS:-15} warm_ups=${WARM_UPS:-5} random=${RANDOM_RAYS:-4000000}
IFS=, read -r width height samples <<<"${PRIMARY:-1920,1080,4}"
fixtures=(bearing caster gear mug propeller spring vase)
models=("${fixtures[@]/#/fixtures/}")
models=("${models[@]/%//model.step}" "$@")
read -r -a pictures <<<"${PICTURES:-fixtures/gear/model.step fixtures/mug/model.step}"
mkdir -p "$out"
export REQUIRE_GPU=1
failed=0
attempt() {
    local name=$1
    shift
    printf '== %s (%d s)\n' "$name" "$SECONDS"
    if ! "$@"; then
        echo "FAILED: $name"
        failed=$((failed + 1))
    fi
}
into() {
    local file=$1
    shift
    "$@" >"$file"
}

attempt "picture" "$trimray" render "${models[0]}" -o "$out/picture.png" --device gpu --no-cache
for test in "${tests[@]}"; do
    attempt "tests of $(basename "$test")" "$test"
done
load=(--resolution "$width,$height" --rays-per-pixel "$samples" --rays "$random" --repeat "$runs" --warm-ups "$warm_ups" --json)
attempt "kernels" into "$out/kernels.jsonl" "$trimray" bench stages "${models[@]}" --frames --kernels --device gpu "${load[@]}"
attempt "trims" into "$out/trims.txt" "$trimray" bench trim "${models[@]}" --methods 3,4,12,29,30 --gpu --repeat "$runs" --csv "$out/trims.csv"
for device in gpu cpu; do
    # The CPU is there to compare with: a few runs are enough.
    counts=(--repeat 3 --warm-ups 1)
    [ $device = cpu ] && counts=(--repeat 1 --warm-ups 0)
    attempt "pictures, $device" into "$out/pictures-$device.jsonl" "$trimray" bench stages "${pictures[@]}" --frames \
        --resolution "$width,$height" --rays-per-pixel "$samples" --json --device $device "${counts[@]}"
done
printf '== done (%d s), %d failed\n' "$SECONDS" "$failed"
exit $((failed > 0))
