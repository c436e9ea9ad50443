#!/usr/bin/env bash
# The pictures of docs/gallery, from the fixtures: make.sh [TRIMRAY]
set -euo pipefail
cd "$(dirname "$0")/../.."
trimray=${1:-target/release/trimray}
render() { "$trimray" render -q --device cpu --resolution 600,400 "fixtures/$1/model.step" -o "docs/gallery/$2.png" "${@:3}"; }
render caster section --section x=50% --edges feature
render gear technical --style technical --hidden-lines dashed
render flange blueprint --style blueprint
render mug edges --edges feature
render pipe-tee cut --section -y=50% --camera-direction -0.4,1,-0.5
"$trimray" render -q --device cpu --resolution 300,200 fixtures/castle-nut/model.step -o docs/gallery/review.png --view review
