#!/usr/bin/env bash
# All that a GPU is asked for, in one run: is its kernel right, and how fast is it?
#
#   measure.sh OUT TRIMRAY [TEST_BINARY...] [-- FILE...]
#
# OUT is a folder for what is measured. TEST_BINARYs are built by `cargo test --release --no-run --test equivalence`; they compare the GPU with the CPU.
# FILEs are measured beside the fixtures. Nothing is compiled here, so that the machine with the GPU needs neither Rust nor a network.
# Everything that fails is told, and the rest goes on. RUNS and WARM_UPS (15 and 5, as in Sloup and Havran 2021) and PRIMARY, pixels and rays through each of
# them ("1920,1080,4 3840,2160,8"), make it shorter.
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
runs=${RUNS:-15} warm_ups=${WARM_UPS:-5} primary=${PRIMARY:-1920,1080,4 3840,2160,8}
fixtures=(bearing caster gear mug propeller spring vase)
models=("${fixtures[@]/#/fixtures/}")
models=("${models[@]/%//model.step}" "$@")
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

attempt "picture" "$trimray" render "${models[0]}" -o "$out/picture.png" --device gpu --no-cache
for test in "${tests[@]}"; do
    attempt "tests of $(basename "$test")" "$test"
done
for load in $primary; do
    IFS=, read -r width height samples <<<"$load"
    stages=(bench stages "${models[@]}" --frames --resolution "$width,$height" --rays-per-pixel "$samples" --json)
    for device in gpu cpu; do
        # The CPU is there to compare with: a few runs are enough.
        counts=(--repeat "$runs" --warm-ups "$warm_ups")
        [ $device = cpu ] && counts=(--repeat 1 --warm-ups 0)
        file="$out/stages-$device-${width}x$height.jsonl"
        attempt "stages, $device, $width by $height by $samples" \
            bash -c '"$@" >"$0"' "$file" "$trimray" "${stages[@]}" --device $device "${counts[@]}"
    done
done
attempt "trims" bash -c '"$@" >"$0"' "$out/trims.txt" "$trimray" bench trim "${models[@]}" --methods 3,4,12,29,30 --gpu \
    --repeat "$runs" --csv "$out/trims.csv"
printf '== done (%d s), %d failed\n' "$SECONDS" "$failed"
exit $((failed > 0))
