# shellcheck shell=sh
# Shared by scripts/run and scripts/test, which set `root`.

wanted_packages() {
  sed '/^#/d' "${root:?}/scripts/packages.txt" | tr '\n' ' '
}

missing_packages() {
  for package in $(wanted_packages); do
    status=$(dpkg-query -W -f '${db:Status-Status}' "$package" 2>/dev/null) || status=none
    [ "$status" = installed ] || printf '%s ' "$package"
  done
}

install_missing() {
  if ! command -v apt-get >/dev/null 2>&1; then
    echo "No apt here; under Debian's names these are needed: $(wanted_packages)" >&2
    return 0 # they may be there under other names: the build will tell
  fi
  packages=$(missing_packages)
  [ -n "$packages" ] || return 0
  if [ "$(id -u)" = 0 ]; then
    as_root="env"
  elif command -v sudo >/dev/null 2>&1 && { [ -t 0 ] || sudo -n true 2>/dev/null; }; then
    as_root="sudo env"
  else
    echo "Missing packages; install them as root and call again: apt-get install $packages" >&2
    exit 2
  fi
  echo "Installing $packages"
  $as_root DEBIAN_FRONTEND=noninteractive apt-get update -qq
  # shellcheck disable=SC2086 # a list of words
  $as_root DEBIAN_FRONTEND=noninteractive \
    apt-get install -y -qq --no-install-recommends $packages >/dev/null
}

# build [CMAKE_OPTION...]: the release preset, on all cores.
build() {
  (
    cd "${root:?}" || exit 2
    mkdir -p build
    cmake --preset release "$@" >build/configure.log 2>&1 || {
      cat build/configure.log >&2
      exit 2
    }
    cmake --build --preset release -j "$(nproc)"
  )
}
