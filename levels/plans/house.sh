#!/bin/sh
# Writes house.svg with Inkscape: a house on layers, one user unit a centimetre. Inkscape makes bodies of
# the walls' thick strokes and unites them; doors are clones of one symbol; windows lie over walls that
# run on behind them; furniture and texts have layers of their own.
set -e
out=${1:-house.svg}
draft=$(mktemp --suffix=.svg)
trap 'rm -f "$draft"' EXIT
cat > "$draft" <<'SVG'
<svg xmlns="http://www.w3.org/2000/svg" xmlns:xlink="http://www.w3.org/1999/xlink"
  xmlns:inkscape="http://www.inkscape.org/namespaces/inkscape" width="12000mm" height="9000mm" viewBox="0 0 1200 900">
 <title>House</title>
 <defs>
  <g id="door" style="fill:none;stroke:#000000;stroke-width:2">
   <path id="leaf" d="M 0,0 V -90"/>
   <path id="swing" d="M 0,-90 A 90,90 0 0 1 90,0"/>
  </g>
 </defs>
 <g inkscape:groupmode="layer" id="layer1" inkscape:label="Walls" transform="translate(100,100)">
  <path id="outer" style="fill:none;stroke:#000000;stroke-width:30" d="M 550,685 H 985 V 15 H 15 V 685 H 450"/>
  <path id="across" style="fill:none;stroke:#000000;stroke-width:12" d="M 400,20 V 500 M 400,590 V 680"/>
  <path id="along" style="fill:none;stroke:#000000;stroke-width:12" d="M 400,350 H 520 M 610,350 H 980"/>
  <path id="round" style="fill:none;stroke:#000000;stroke-width:12" d="M 20,450.2273 A 220,220 0 0 1 156.1868,489.7865 M 212.3883,546.9776 A 220,220 0 0 1 249.7727,680"/>
 </g>
 <g inkscape:groupmode="layer" id="layer2" inkscape:label="Doors" transform="translate(100,100)">
  <use id="use1" xlink:href="#door" transform="translate(400,500) rotate(90)"/>
  <use id="use2" xlink:href="#door" x="520" y="350"/>
  <use id="use3" xlink:href="#door" transform="matrix(-1.11111111,0,0,1.11111111,550,685)"/>
  <path id="path7" style="fill:none;stroke:#000000" d="M 156.1868,489.7865 L 212.3883,546.9776"/>
 </g>
 <g inkscape:groupmode="layer" id="layer3" inkscape:label="Windows" style="fill:#ccddff;stroke:#000000" transform="translate(100,100)">
  <rect id="rect1" x="150" y="0" width="180" height="30"/>
  <rect id="rect2" x="600" y="0" width="200" height="30"/>
  <rect id="rect3" x="970" y="450" width="30" height="150"/>
 </g>
 <g inkscape:groupmode="layer" id="layer4" inkscape:label="Furniture" style="fill:none;stroke:#808080" transform="translate(100,100)">
  <rect id="bed" x="700" y="60" width="200" height="160"/>
  <ellipse id="table" cx="800" cy="520" rx="90" ry="60"/>
  <rect id="sofa" x="80" y="100" width="220" height="90" transform="rotate(-8,190,145)"/>
 </g>
 <g inkscape:groupmode="layer" id="layer5" inkscape:label="Labels" style="font-size:28px;font-family:sans-serif" transform="translate(100,100)">
  <text id="text1" x="120" y="300">Living room</text>
  <text id="text2" x="50" y="620">Pantry</text>
  <text id="text3" x="480" y="300">Bedroom</text>
  <text id="text4" x="480" y="640">Kitchen</text>
 </g>
</svg>
SVG
inkscape "$draft" --actions="select-by-id:outer,across,along,round;object-stroke-to-path;path-union;select-clear;select-by-id:table;object-to-path;select-clear;export-filename:$out;export-overwrite;export-do" 2>/dev/null
