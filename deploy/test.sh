#!/usr/bin/env bash
# Runs every test that needs no GPU.
#
#   deploy/test.sh [STAGE...]      all stages, or only the named ones
#
# Works on a fresh Debian 12/13 or Ubuntu 22.04/24.04 that has Rust: installs
# what is missing (and says so). All stages run even when an earlier one fails;
# the closing line counts the tests as the runners reported them, and a stage
# that fails without naming a failed test (lint, build) counts as one failure.
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")/.."
# shellcheck source=deploy/lib.sh
. deploy/lib.sh
# shellcheck source=deploy/count.sh
. deploy/count.sh

STAGES=(scripts web format build lint rust doctest docs browser)
LOGS=$PWD/target/test-logs

# Stage bodies run under `||`, where `set -e` does not act: steps are joined by &&.
stage_scripts() { shellcheck -x deploy/*.sh .ci/run && bash deploy/count_test.sh && bash deploy/lib_test.sh; }

stage_web() {
    npm_packages web &&
        (cd web && npm run --silent lint && npm test --silent && npm run --silent build)
}

stage_format() { cargo fmt --all --check -- --color never; }

# One selection of packages and targets for building, linting and testing:
# another one would unify features differently and build the dependencies anew.
stage_build() { cargo build --locked --workspace --all-targets; }

stage_lint() { cargo clippy --locked --workspace --all-targets -- -D warnings; }

stage_rust() {
    if cargo nextest --version >/dev/null 2>&1; then
        cargo nextest run --locked --workspace --all-targets --no-fail-fast
    else
        say 'cargo-nextest is not installed: using cargo test, which is slower'
        cargo test --locked --workspace --all-targets --no-fail-fast
    fi
}

stage_doctest() { cargo test --locked --workspace --doc; }

stage_docs() { RUSTDOCFLAGS='-D warnings' cargo doc --locked --workspace --no-deps; }

stage_browser() {
    if [ ! -x target/debug/tyndall ]; then
        echo 'target/debug/tyndall is not there: stage build comes first'
        return 1
    fi
    npm_packages tests/browser && (cd tests/browser && timeout --kill-after=10s 20m npm test --silent)
}

# These must report at least one test: a runner that finds none has failed.
runs_tests() { [[ $1 == web || $1 == rust || $1 == browser ]]; }

run_stage() {
    local name=$1 log=$LOGS/$1.log start=$SECONDS status=0 counts passed failed skipped
    printf '\n=== %s\n' "$name"
    "stage_$name" </dev/null 2>&1 | tee "$log" || status=$?
    counts=$(count_tests "$log")
    read -r passed failed skipped <<<"$counts"
    if [ "$status" -eq 0 ] && runs_tests "$name" && [ $((passed + failed)) -eq 0 ]; then
        say "stage $name reported no test"
        status=1
    fi
    if [ "$status" -ne 0 ]; then
        FAILED_STAGES+=("$name")
        if [ "$failed" -eq 0 ]; then
            failed=1
        fi
    elif [ "$failed" -ne 0 ]; then
        FAILED_STAGES+=("$name")
    fi
    PASSED=$((PASSED + passed))
    FAILED=$((FAILED + failed))
    SKIPPED=$((SKIPPED + skipped))
    REPORT+=("$(printf '%-8s %5d s  %s' "$name" $((SECONDS - start)) \
        "$([ "$status" -eq 0 ] && echo ok || echo FAILED), $passed passed, $failed failed, $skipped skipped")")
}

set_up() {
    require_rust
    ensure_system_packages
    ensure_node
    apt_ensure 'shellcheck checks the scripts in deploy/'
    ensure_chromium
    fetch_crates
}

# The software driver is chosen by name, so that results do not depend on
# whether the machine has a GPU.
set_environment() {
    local driver
    driver=$(lavapipe_driver_file)
    [ -n "$driver" ] || die 'lavapipe is not installed although mesa-vulkan-drivers is: no lvp_icd file for the Vulkan loader'
    export VK_DRIVER_FILES=$driver VK_ICD_FILENAMES=$driver
    # Kernels compile at their first dispatch and every test is its own
    # process: one cache on disk for all of them, kept between runs.
    export MESA_SHADER_CACHE_DIR=$PWD/target/mesa-shader-cache
    mkdir -p "$LOGS" "$MESA_SHADER_CACHE_DIR"
    ensure_runtime_dir
    export TYNDALL_BIN=$PWD/target/debug/tyndall CHROMIUM
    # The counts are read from the logs; a snapshot is never written here.
    export NO_COLOR=1 CARGO_TERM_COLOR=never INSTA_UPDATE=no
    unset FORCE_COLOR
    if [ "${CI:-}" = true ]; then
        export CARGO_INCREMENTAL=0 # a fresh clone gains nothing from it
    fi
}

SELECTED=("$@")
if [ $# -eq 0 ]; then
    SELECTED=("${STAGES[@]}")
fi
for name in "${SELECTED[@]}"; do
    [[ " ${STAGES[*]} " == *" $name "* ]] || die "no stage named $name; stages: ${STAGES[*]}"
done

PASSED=0 FAILED=0 SKIPPED=0 FAILED_STAGES=() REPORT=()
mkdir -p target
set_up
set_environment
REPORT+=("$(printf '%-8s %5d s' set-up "$SECONDS")")
for name in "${SELECTED[@]}"; do
    run_stage "$name"
done

printf '\n=== summary\n'
printf '%s\n' "${REPORT[@]}"
printf '%-8s %5d s\n' total "$SECONDS"
if [ ${#FAILED_STAGES[@]} -gt 0 ]; then
    say "failed: ${FAILED_STAGES[*]} (logs: target/test-logs/)"
fi
printf '%d passed, %d failed, %d skipped\n' "$PASSED" "$FAILED" "$SKIPPED"
[ ${#FAILED_STAGES[@]} -eq 0 ]
