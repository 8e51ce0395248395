# shellcheck shell=bash
# Steps that run.sh and test.sh share: what the machine lacks is installed by
# apt, each package with the reason printed; what apt cannot give (Rust) ends
# the script with one line that says what to do. Every step looks first and
# acts only where something is missing, so a second run changes nothing.
#
# Sourced, never run. The caller has set -euo pipefail and stands in the
# repository's root.

# Oldest versions that the project builds with. MIN_RUST is rust-version of
# Cargo.toml; MIN_NODE is what Vite asks for.
MIN_RUST=1.95
MIN_NODE=20.19
# From the npm registry where the distribution's Node is too old (see
# ensure_node); the newest of each major line is taken.
NODE_LINE=22
NPM_LINE=10

TOOLS_DIR=$PWD/target/tools
BACKPORTS_FILE=/etc/apt/sources.list.d/tyndall-backports.sources

export DEBIAN_FRONTEND=noninteractive

say() { printf 'tyndall: %s\n' "$*"; }

die() {
    printf 'tyndall: error: %s\n' "$*" >&2
    exit 1
}

# version_at_least FOUND WANTED: dotted numbers, compared as versions.
version_at_least() {
    [ "$(printf '%s\n%s\n' "$2" "$1" | sort -V | head -n 1)" = "$2" ]
}

may_be_root() { [ "$(id -u)" -eq 0 ] || command -v sudo >/dev/null 2>&1; }

# Runs a command as root, through sudo where that is needed.
as_root() {
    if [ "$(id -u)" -eq 0 ]; then
        "$@"
    else
        sudo env DEBIAN_FRONTEND=noninteractive "$@"
    fi
}

require_apt() {
    command -v apt-get >/dev/null 2>&1 ||
        die "apt-get not found: these scripts set up Debian 12/13 and Ubuntu 22.04/24.04; elsewhere install the packages named in README.md by hand, then use cargo and npm directly"
}

is_installed() {
    # shellcheck disable=SC2016 # dpkg-query expands this, not the shell
    [ "$(dpkg-query -W -f '${db:Status-Status}' "$1" 2>/dev/null)" = installed ]
}

# Runs apt-get as root without questions. Its progress goes to a log that is
# shown when it fails; a busy lock (a new machine updating itself) is waited for.
apt_get() {
    local log=$PWD/target/apt.log
    mkdir -p target
    if ! as_root apt-get -qq -y -o DPkg::Lock::Timeout=300 "$@" </dev/null >"$log" 2>&1; then
        tail -n 5 "$log" >&2
        return 1
    fi
}

# apt_update: once a run, and only when something is to be installed.
APT_LISTS_FRESH=no
apt_update() {
    if [ "$APT_LISTS_FRESH" = no ]; then
        apt_get update ||
            die "apt-get update failed: check the network and the entries in /etc/apt"
        APT_LISTS_FRESH=yes
    fi
}

# apt_ensure 'PACKAGE REASON...' ...: installs the packages that are missing.
apt_ensure() {
    local entry package missing=()
    for entry in "$@"; do
        package=${entry%% *}
        if ! is_installed "$package"; then
            say "will install $package: ${entry#* }"
            missing+=("$package")
        fi
    done
    if [ ${#missing[@]} -gt 0 ]; then
        may_be_root ||
            die "installing needs root and there is no sudo; as root: apt-get install ${missing[*]}"
        apt_update
        apt_get install --no-install-recommends "${missing[@]}" ||
            die "apt-get could not install ${missing[*]}: see its message above"
    fi
}

# What both scripts need to build and to run without a GPU.
ensure_system_packages() {
    require_apt
    apt_ensure \
        'build-essential C compiler and linker for Rust and for the JPEG codec' \
        'pkg-config finds system libraries while crates build' \
        'cmake builds the JPEG codec (libjpeg-turbo)' \
        'nasm assembles the JPEG codec, several times faster with it' \
        'libvulkan1 Vulkan loader, the way to every GPU driver' \
        'mesa-vulkan-drivers Vulkan drivers, lavapipe (no GPU needed) among them' \
        'ca-certificates lets cargo and npm check the registries they talk to'
    ensure_newer_mesa
}

# Debian 12 ships Mesa 22.3, whose lavapipe recompiles kernels at every
# dispatch, leaks when it does and cuts long loops short; 25 from backports has
# none of that. The suite's address is derived from the sources that this
# machine already uses. Not having it costs speed, never correctness, so
# nothing here ends the script.
ensure_newer_mesa() {
    # Only Debian 12 has both the old driver and a newer one in backports.
    [ "$(. /etc/os-release && echo "${ID:-}-${VERSION_CODENAME:-}")" = debian-bookworm ] || return 0
    local version
    # shellcheck disable=SC2016 # dpkg-query expands this, not the shell
    version=$(dpkg-query -W -f '${Version}' mesa-vulkan-drivers)
    if version_at_least "$version" 25; then
        return 0
    fi
    if ! install_mesa_from_backports; then
        say "staying on Mesa $version: bookworm-backports cannot be had here (slower without a GPU, same pictures)"
    fi
}

install_mesa_from_backports() {
    may_be_root || return 1
    # shellcheck disable=SC2016 # apt expands these, not the shell
    local format='$(RELEASE) $(COMPONENT) $(REPO_URI)' targets mirror
    targets=$(apt-get indextargets --format "$format" 'Created-By: Packages') || return 1
    if ! grep -q '^bookworm-backports main ' <<<"$targets"; then
        mirror=$(awk '$1 == "bookworm" && $2 == "main" { print $3; exit }' <<<"$targets")
        [ -n "$mirror" ] || return 1
        say "will add $BACKPORTS_FILE: bookworm-backports of $mirror, for a newer Mesa"
        add_backports_source "$mirror" || {
            as_root rm -f "$BACKPORTS_FILE"
            return 1
        }
    fi
    say 'will install mesa-vulkan-drivers from bookworm-backports: its lavapipe is faster and lacks three faults of Mesa 22.3'
    apt_get install --no-install-recommends -t bookworm-backports mesa-vulkan-drivers || {
        as_root rm -f "$BACKPORTS_FILE"
        return 1
    }
}

# Writes the source and reads only it, so that a mirror without the suite is
# found out before apt's own lists are touched.
add_backports_source() {
    local keyring=/usr/share/keyrings/debian-archive-keyring.gpg
    {
        echo '# Added by deploy/lib.sh of tyndall for mesa-vulkan-drivers; safe to delete.'
        echo 'Types: deb'
        echo "URIs: $1"
        echo 'Suites: bookworm-backports'
        echo 'Components: main'
        if [ -e "$keyring" ]; then
            echo "Signed-By: $keyring"
        fi
    } | as_root tee "$BACKPORTS_FILE" >/dev/null || return 1
    apt_get update \
        -o Dir::Etc::sourcelist="$BACKPORTS_FILE" -o Dir::Etc::sourceparts=- \
        -o APT::Get::List-Cleanup=0 -o APT::Update::Error-Mode=any
}

require_rust() {
    # A fresh rustup writes its path to the shell's profile, which a script
    # started from an older shell has not read.
    if ! command -v cargo >/dev/null 2>&1 && [ -x "${CARGO_HOME:-$HOME/.cargo}/bin/cargo" ]; then
        PATH=${CARGO_HOME:-$HOME/.cargo}/bin:$PATH
        export PATH
    fi
    local fix="install Rust $MIN_RUST or newer with rustup (https://rustup.rs), then run this again"
    command -v cargo >/dev/null 2>&1 || die "cargo not found: $fix"
    local found
    found=$(rustc --version | awk '{ print $2 }') || die "rustc does not run: $fix"
    version_at_least "$found" "$MIN_RUST" || die "rustc $found is too old: $fix"
    say "rustc $found"
}

# Separately from the build, so that a missing network has its own line.
fetch_crates() {
    cargo fetch --locked --quiet --target "$(rustc --print host-tuple)" ||
        die 'the crates could not be fetched: see the message of cargo above (network, or a Cargo.lock that lags behind Cargo.toml)'
}

node_version() { node --version 2>/dev/null | sed 's/^v//'; }

# Node for the page's build: the one that is there, else the distribution's,
# else, where that is too old (Debian 12, Ubuntu), a newer one which the npm
# registry carries as a package, under target/tools and nowhere else.
ensure_node() {
    if ! have_node && [ -x "$TOOLS_DIR/bin/node" ]; then
        PATH=$TOOLS_DIR/bin:$PATH
        export PATH
    fi
    if ! have_node && ! command -v node >/dev/null 2>&1; then
        apt_ensure \
            'nodejs builds the page and runs the end-to-end tests' \
            'npm fetches what the page is built from'
    fi
    if ! have_node; then
        install_node_package
    fi
    say "node $(node_version), npm $(npm --version)"
}

have_node() {
    command -v node >/dev/null 2>&1 && command -v npm >/dev/null 2>&1 &&
        version_at_least "$(node_version)" "$MIN_NODE"
}

install_node_package() {
    local arch
    case $(uname -m) in
    x86_64) arch=x64 ;;
    aarch64) arch=arm64 ;;
    *) arch= ;;
    esac
    local fix="install Node.js $MIN_NODE or newer with npm, then run this again"
    [ -n "$arch" ] || die "node $(node_version) is too old: $fix"
    command -v npm >/dev/null 2>&1 || apt_ensure 'npm fetches a newer Node.js'
    say "will install Node.js $NODE_LINE and npm $NPM_LINE from the npm registry into target/tools: node $(node_version) is older than $MIN_NODE"
    mkdir -p "$TOOLS_DIR/bin"
    npm install --loglevel=error --no-save --no-audit --no-fund --prefix "$TOOLS_DIR" \
        "node-linux-$arch@$NODE_LINE" "npm@$NPM_LINE" </dev/null ||
        die "Node.js could not be fetched from the npm registry: $fix"
    ln -sf "../node_modules/node-linux-$arch/bin/node" "$TOOLS_DIR/bin/node"
    ln -sf ../node_modules/npm/bin/npm-cli.js "$TOOLS_DIR/bin/npm"
    ln -sf ../node_modules/npm/bin/npx-cli.js "$TOOLS_DIR/bin/npx"
    PATH=$TOOLS_DIR/bin:$PATH
    export PATH
    hash -r
    have_node || die "the Node.js from the npm registry does not run here: $fix"
}

# The browser of the end-to-end tests. Debian has it as a package; Ubuntu only as
# a snap, so there any Chrome or Chromium that is already installed is taken.
# Its path is left in CHROMIUM.
ensure_chromium() {
    if ! CHROMIUM=$(find_chromium); then
        require_apt
        may_be_root && apt_update
        apt-cache show chromium >/dev/null 2>&1 ||
            die 'no Chromium or Chrome found and apt has no package "chromium": install either one (on Ubuntu: snap install chromium), then run this again'
        apt_ensure 'chromium the browser that the end-to-end tests drive'
        CHROMIUM=$(find_chromium) || die 'chromium was installed but is not in PATH'
    fi
    say "browser $CHROMIUM"
}

find_chromium() {
    command -v "${CHROMIUM:-chromium}" || command -v chromium || command -v chromium-browser ||
        command -v google-chrome-stable || command -v google-chrome
}

# npm_packages FOLDER: npm ci there, unless what is installed came from the
# same lock file.
npm_packages() {
    local stamp=$1/node_modules/.tyndall-lock
    if [ -e "$stamp" ] && cmp -s "$stamp" "$1/package-lock.json"; then
        return 0
    fi
    (cd "$1" && npm ci --no-audit --no-fund) || return 1
    cp "$1/package-lock.json" "$stamp"
}

# page_is_current: whether web/dist was built after every change of what it is
# built from; a file that is gone changes its folder.
page_is_current() {
    local newer
    [ -e web/dist/index.html ] || return 1
    newer=$(find web -mindepth 1 \( -path web/node_modules -o -path web/dist \) -prune \
        -o -newer web/dist/index.html -print -quit) || return 1
    [ -z "$newer" ]
}

# The Vulkan loader and Mesa complain of a missing one at every start.
ensure_runtime_dir() {
    if [ ! -d "${XDG_RUNTIME_DIR:-}" ]; then
        export XDG_RUNTIME_DIR=$PWD/target/xdg-runtime
        mkdir -p "$XDG_RUNTIME_DIR"
        chmod 700 "$XDG_RUNTIME_DIR"
    fi
}

# Where lavapipe is described to the Vulkan loader; empty if it is not there.
lavapipe_driver_file() {
    local folder file
    for folder in /usr/share/vulkan/icd.d /etc/vulkan/icd.d /usr/local/share/vulkan/icd.d; do
        for file in "$folder"/lvp_icd*.json; do
            if [ -e "$file" ]; then
                echo "$file"
                return 0
            fi
        done
    done
}
