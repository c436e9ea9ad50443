#!/usr/bin/env bash
# The pictures of docs/gallery, from the fixtures: make.sh [TRIMRAY [cpu|gpu [FOLDER]]]
set -euo pipefail
cd "$(dirname "$0")/../.."
trimray=${1:-target/release/trimray}
device=${2:-cpu}
folder=${3:-docs/gallery}
render() { "$trimray" render -q --device "$device" --resolution 600,400 "fixtures/$1/model.step" -o "$folder/$2.png" "${@:3}"; }
"$trimray" render -q --device "$device" --resolution 900,540 fixtures/bearing/model.step -o "$folder/bearing.png" --camera-elevation-angle 22
render caster section --section x=50% --edges feature
render gear technical --style technical --hidden-lines dashed
render flange blueprint --style blueprint
render mug edges --edges feature
render caster quarter --section x=50% --section -y=50% --section-mode corner --edges feature
render pipe-tee cut --section -y=50% --camera-direction -0.4,1,-0.5
light=$(mktemp -d)
trap 'rm -r "$light"' EXIT
cat > "$light/looks.toml" <<'LOOKS'
["Felge"]
color = "#c8c8cc"
metallic = 1
roughness = 0.25

["Reifen"]
color = "#202024"
roughness = 0.7
LOOKS
python3 tools/gallery/hdri.py "$light/evening.hdr"
looks=(--materials "$light/looks.toml" --color '#3d6d9e')
render caster looks "${looks[@]}" --fit 0.8
render caster path-traced "${looks[@]}" --fit 0.8 --path-trace --ground --spp 256 --noise 0.008
render mug metal --color '#f2d5a0' --metallic 1 --roughness 0.25 --fit 0.85 --path-trace --ground --spp 256 --noise 0.008 \
    --hdri "$light/evening.hdr" --hdri-background --tone-mapping agx --exposure 1
"$trimray" render -q --device "$device" --resolution 300,200 fixtures/castle-nut/model.step -o "$folder/review.png" --view review --labels
