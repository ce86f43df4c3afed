#!/bin/sh
# Loads every mesh file of a folder with csx600 and prints a table: the file, its triangles or the reason why it is refused,
# and the count of triangles that a second reader (assimp where it is installed, or awk) finds.
#
#     tests/program/load_folder.sh CSX600 FOLDER [PATTERN...]       patterns of file names, default *.obj *.ply *.gltf *.glb
#
# The second reader's count is compared with all that csx600 reads: triangles, and those that it leaves out because they
# have no area or repeat another one. "same", "differs" or "-" (no second count) stands in the last column. Exit code 0,
# whatever the files hold: the table is the result.
set -u
program=$1
folder=$2
shift 2
[ $# -gt 0 ] || set -- '*.obj' '*.ply' '*.gltf' '*.glb'

# The triangles that assimp finds after it has cut polygons (points and lines count as well). Without assimp, or for a file
# that it cannot read: the sum of corners less two of an OBJ file's faces.
second_count() {
  count=
  if command -v assimp > /dev/null; then
    count=$(timeout 60 assimp info "$1" -tri 2> /dev/null | sed -n 's/^Faces: *\([0-9]*\).*/\1/p' | head -n 1)
  fi
  case ${count:-none}$1 in
    none*.[oO][bB][jJ]) awk '$1 == "f" { sub(/#.*/, ""); sum += NF - 3 } END { print sum + 0 }' "$1" ;;
    *) echo "$count" ;;
  esac
}

find_meshes() {
  for pattern; do find "$folder" -type f -iname "$pattern"; done | LC_ALL=C sort
}

statistics=$(mktemp)
trap 'rm -f "$statistics"' EXIT
loaded=0
files=0
same=0
printf '%-60s %10s %10s  %s\n' file triangles second compared
find_meshes "$@" | {
  while IFS= read -r file; do
    files=$((files + 1))
    output=$(timeout 120 "$program" render "$file" --allow-outside --native --samples 1 --size 8x8 --stats "$statistics" 2>&1)
    code=$?
    triangles=$(sed -n 's/^  "triangles": \([0-9]*\),$/\1/p' "$statistics")
    second=$(second_count "$file")
    if [ "$code" -ne 0 ]; then
      reason=$(printf '%s\n' "$output" | grep '^csx600: ' | grep -v '^csx600: note' | head -n 1)
      printf '%-60s %10s %10s  exit %d: %s\n' "${file#"$folder"/}" refused "${second:--}" "$code" "$reason"
      continue
    fi
    loaded=$((loaded + 1))
    left_out=$(printf '%s\n' "$output" | sed -n 's/^csx600: note: .*: a triangle .* is left out\(, \([0-9]*\) times\)\{0,1\}$/\2/p' |
      awk '{ sum += $1 == "" ? 1 : $1 } END { print sum + 0 }')
    added=$(printf '%s\n' "$output" | grep -c 'square light .* is added')
    : "${triangles:?the statistics of $file name no triangles}"
    total=$((triangles + left_out - 2 * added))
    verdict=-
    if [ -n "$second" ]; then
      verdict=differs
      [ "$total" -eq "$second" ] && verdict=same && same=$((same + 1))
    fi
    printf '%-60s %10d %10s  %s\n' "${file#"$folder"/}" "$total" "${second:--}" "$verdict"
  done
  printf '%d files, %d loaded, %d with the second reader'\''s count\n' "$files" "$loaded" "$same"
}
