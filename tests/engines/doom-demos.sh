#!/usr/bin/env bash
# Plays a game's demos with the game's own REJECT tables, with those that enfilade exports, and with a
# table that hides everything, and compares what the players did, tic by tic.
#
#     apt-get install freedoom dsda-doom chocolate-doom      # one engine will do
#     tests/engines/doom-demos.sh                            # all demos of Freedoom
#     tests/engines/doom-demos.sh --maps E1M4,MAP10          # only those on these maps
#
# Passes if every demo goes with the exported table exactly as without it, and if the table that hides
# everything changes at least one (so that the comparison is known to notice). dsda-doom writes a trace
# of every tic, which is compared byte by byte; of chocolate-doom only the number of tics is.
#
# Options: --maps NAMES  only demos on these maps       --wads FILES   the games (with commas)
#          --program F   the enfilade to run            --keep FOLDER  keep WADs and traces there
# Exit status: 0 all the same; 1 some demo differs; 3 nothing to play with (no engine, or no game).
set -euo pipefail
export PATH="$PATH:/usr/games" SDL_VIDEODRIVER=dummy SDL_AUDIODRIVER=dummy LC_ALL=C

here=$(cd "$(dirname "$0")/../.." && pwd)
maps= keep= program= wads=/usr/share/games/doom/freedoom1.wad,/usr/share/games/doom/freedoom2.wad
while [ $# -gt 0 ]; do
    case $1 in
        --maps) maps=$2; shift 2 ;;
        --wads) wads=$(IFS=,; for wad in $2; do printf '%s,' "$(realpath "$wad")"; done); shift 2 ;;
        --program) program=$(realpath "$2"); shift 2 ;;
        --keep) keep=$2; shift 2 ;;
        *) sed -n '2,/^set/s/^# \{0,1\}//p' "$0" >&2; exit 2 ;;
    esac
done
if [ -z "$program" ]; then
    cargo build --release --quiet --manifest-path "$here/Cargo.toml"
    program=$here/target/release/enfilade
fi
work=${keep:-$(mktemp -d)}
mkdir -p "$work"
[ -n "$keep" ] || trap 'rm -rf "$work"' EXIT
cd "$work"

engines=()
for engine in dsda-doom chocolate-doom; do
    if command -v "$engine" >/dev/null; then engines+=("$engine"); fi
done
if [ ${#engines[@]} -eq 0 ]; then
    echo "no engine: apt-get install dsda-doom chocolate-doom" >&2
    exit 3
fi

# part OFFSET SIZE FILE: bytes of a file.
part() { dd if="$3" bs=64K iflag=skip_bytes,count_bytes skip="$1" count="$2" status=none; }

# number OFFSET FILE: the little-endian number of four bytes there.
number() { od -An -tu4 --endian=little -j "$1" -N 4 "$2" | tr -d ' '; }

# lumps WAD: a line for each lump: its offset, size and name.
lumps() {
    local count directory
    count=$(number 4 "$1")
    directory=$(number 8 "$1")
    part "$directory" $((count * 16)) "$1" |
        od -An -v -tu1 -w16 | awk '{
            name = ""
            for (i = 9; i <= 16 && $i != 0; i++) name = name sprintf("%c", $i)
            print $1 + 256 * ($2 + 256 * ($3 + 256 * $4)), $5 + 256 * ($6 + 256 * ($7 + 256 * $8)), name
        }'
}

# play ENGINE WAD DEMO-LUMP DEMO-FILE EXTRA-WAD: what happened goes into the file `played`.
play() {
    local extra=()
    if [ -n "$5" ]; then extra=(-file "$5"); fi
    rm -f played played.gst
    case $1 in
        dsda-doom)
            timeout 300 dsda-doom -iwad "$2" "${extra[@]}" -timedemo "$4" -nodraw -nosound -nomouse \
                -nojoy -noautoload -no_message_box -export_ghost played >log 2>&1 || return 1
            mv played.gst played ;;
        chocolate-doom)
            # It ends a timed demo as an error, with status 255.
            timeout 300 chocolate-doom -iwad "$2" "${extra[@]}" -timedemo "$3" -nodraw \
                -nosound -nogui >log 2>&1 || true
            grep -o 'timed [0-9]* gametics' log >played || return 1 ;;
    esac
}

played=0 differ=0 noticed=0
for wad in ${wads//,/ }; do
    if [ ! -r "$wad" ]; then
        echo "no game: $wad is not there (apt-get install freedoom)" >&2
        continue
    fi
    game=$(basename "$wad" .wad)
    lumps "$wad" >"$game.lumps"
    while read -r offset size lump; do
        demo=$game-${lump,,}.lmp
        part "$offset" "$size" "$wad" >"$demo"
        # Bytes of the demo's head: version, skill, episode, map.
        read -r _ _ episode number < <(od -An -tu1 -N 4 "$demo")
        if grep -q ' E1M1$' "$game.lumps"; then
            map=E${episode}M$number
        else
            map=$(printf 'MAP%02d' "$number")
        fi
        if [ -n "$maps" ] && [[ ",$maps," != *",$map,"* ]]; then continue; fi
        "$program" export reject "$wad" --map "$map" --alone -o "$game-$map.wad" --quiet
        "$program" export reject "$wad" --map "$map" -o "$game-$map.rej" --quiet
        # The same WAD, its table all ones.
        cp "$game-$map.wad" "$game-$map-blind.wad"
        read -r at bytes _ < <(lumps "$game-$map.wad" | grep ' REJECT$')
        head -c "$bytes" /dev/zero | tr '\0' '\377' |
            dd of="$game-$map-blind.wad" bs=1 seek="$at" conv=notrunc status=none
        # And the lump alone is the lump in the WAD.
        part "$at" "$bytes" "$game-$map.wad" | cmp - "$game-$map.rej"
        for engine in "${engines[@]}"; do
            line="$engine $game ${lump,,} ($map)"
            for table in own exported blind; do
                case $table in
                    own) extra= ;;
                    exported) extra=$game-$map.wad ;;
                    blind) extra=$game-$map-blind.wad ;;
                esac
                if ! play "$engine" "$wad" "${lump,,}" "$demo" "$extra"; then
                    echo "$line: the engine failed:" >&2
                    tail -5 log >&2
                    exit 1
                fi
                mv played "$engine-${demo%.lmp}.$table"
            done
            trace=$engine-${demo%.lmp}
            played=$((played + 1))
            if cmp -s "$trace.own" "$trace.exported"; then
                verdict="the same with the exported table"
            else
                verdict="DIFFERS with the exported table"
                differ=$((differ + 1))
            fi
            if cmp -s "$trace.own" "$trace.blind"; then
                verdict="$verdict; one that hides all changes nothing"
            else
                verdict="$verdict; one that hides all changes it"
                noticed=$((noticed + 1))
            fi
            echo "$line: $verdict"
        done
    done < <(grep -E ' DEMO[0-9]$' "$game.lumps")
done
if [ "$played" -eq 0 ]; then
    echo "no demo was played" >&2
    exit 3
fi
echo "$played demos played: $differ differ, $noticed noticed a table that hides all"
[ "$differ" -eq 0 ] && [ "$noticed" -gt 0 ]
