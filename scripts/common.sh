# Shared by the scripts of this folder; to be sourced. Names: $root (checkout), $build (build folder), $deps (what set-up makes), $python (its Python).
root=$(cd "$(dirname "${BASH_SOURCE[0]}")/.." && pwd)
build=${JAXMPM_BUILD:-$root/build}
deps=$root/.deps
python=$root/.venv/bin/python
logs=$deps/logs
mkdir -p "$logs"
began=$SECONDS

say() { printf '%s\n' "$*"; }
die() { printf '%s\n' "$*" >&2; exit 1; }

# part NAME COMMAND…: runs a command with its output in a log (and on a terminal in sight), tells how long it took, shows the log when it fails.
part() {
  local name=$1 start=$SECONDS log status
  shift
  log=$logs/$(tr -c 'A-Za-z0-9\n' '-' <<<"$name").log
  set +e  # the subshell stops at its first error: after `||` it would not
  if [ -t 1 ]; then
    say "-- $name"
    (set -e; "$@") 2>&1 | tee "$log"
  else
    (set -e; "$@") >"$log" 2>&1
  fi
  status=$?
  set -e
  if [ "$status" != 0 ]; then
    [ -t 1 ] || tail -n 60 "$log" >&2
    die "$name failed (exit $status) after $((SECONDS - start)) s; its whole output is in $log"
  fi
  printf -- '-- %-46s %4d s\n' "$name" $((SECONDS - start))
}

total() { printf -- '-- %-46s %4d s\n' "$1, all in all" $((SECONDS - began)); }

as_root() {
  if [ "$(id -u)" = 0 ]; then "$@"; else sudo "$@"; fi
}

# install PACKAGE…: those of them that are missing, through apt.
install() {
  local package missing=()
  command -v dpkg-query >/dev/null || { say "This is no Debian system: please provide the like of $*"; return 0; }
  for package; do
    dpkg-query -W -f='${Status}' "$package" 2>/dev/null | grep -q 'ok installed' || missing+=("$package")
  done
  [ ${#missing[@]} = 0 ] && return 0
  if [ "$(id -u)" != 0 ] && ! command -v sudo >/dev/null; then
    die "Missing packages, and neither root nor sudo to install them. As root: apt-get install ${missing[*]}"
  fi
  say "installing ${missing[*]}"
  as_root apt-get -qq update
  # Some 550 packages come with VTK. Not waiting for the disk after each of them, as Debian's own installer does, saves minutes.
  as_root env DEBIAN_FRONTEND=noninteractive apt-get -qq -y --no-install-recommends -o Dpkg::Options::=--force-unsafe-io install "${missing[@]}"
}
set -o pipefail

# build_yardsticks: compiles scripts/yardstick into $deps/yardstick; fails where the processor lacks the AVX-512 that they are written for.
build_yardsticks() {
  local name
  mkdir -p "$deps/yardstick"
  compile_yardstick limits
  grep -q avx512dq /proc/cpuinfo || return 1
  for name in transfer2d transfer3d; do compile_yardstick "$name" -ffast-math; done
}

compile_yardstick() {
  local name=$1
  shift
  part "Build $name" g++ -O3 -march=native -fopenmp "$@" "$root/scripts/yardstick/$name.cpp" -o "$deps/yardstick/$name"
}
