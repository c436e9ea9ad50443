#!/bin/sh
# Fills tools/fuzz/corpus with seeds: small files of the tests, small fixtures, and what a given trimray bakes of them.
set -eu
trimray=$(realpath "$1")
cd "$(dirname "$0")"
root=../..
mkdir -p corpus/part21 corpus/step corpus/iges corpus/bake corpus/cache
for folder in part21 step bake; do
    cp "$root"/tests/bounds/*.step "corpus/$folder/"
    for name in chain spinning-top die; do
        cp "$root/fixtures/$name/model.step" "corpus/$folder/$name.step"
    done
done
for folder in iges bake; do
    for name in spinning-top duct; do
        cp "$root/fixtures/$name/model.igs" "corpus/$folder/$name.igs"
    done
done
for file in "$root"/tests/bounds/*.step "$root"/fixtures/spinning-top/model.step; do
    name=$(basename "$(dirname "$file")")-$(basename "$file" .step)
    "$trimray" bake --quiet "$file" -o "corpus/cache/$name.trimray"
    "$trimray" bake --quiet --keep-f64 "$file" -o "corpus/cache/$name-f64.trimray"
done
