#!/usr/bin/env bash
# Checks count.sh against a sample of each runner's closing lines.
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")/.."
# shellcheck source=deploy/count.sh
. deploy/count.sh

passed=0 failed=0
expect() { # NAME EXPECTED SAMPLE
    local found
    found=$(count_tests <(printf '%b\n' "$3"))
    if [ "$found" = "$2" ]; then
        passed=$((passed + 1))
    else
        echo "$1: found '$found', expected '$2'"
        failed=$((failed + 1))
    fi
}

expect nextest '4 2 3' \
    '     Summary [   1.2s] 6/9 tests run: 4 passed (1 slow, 1 leaky), 1 failed, 1 timed out, 3 skipped'
expect one_nextest '1 0 0' '     Summary [   0.012s] 1 test run: 1 passed, 0 skipped'
expect cargo '5 1 2' \
    'test result: ok. 4 passed; 0 failed; 2 ignored; 0 measured; 9 filtered out; finished in 0.1s\ntest result: FAILED. 1 passed; 1 failed; 0 ignored; 0 measured; 0 filtered out'
expect vitest '4 1 3' ' Test Files  1 failed | 2 passed (3)\n      Tests  1 failed | 4 passed | 2 skipped | 1 todo (8)'
expect node_tap '3 2 1' '# tests 6\n# pass 3\n# fail 1\n# cancelled 1\n# skipped 1\n# todo 0'
expect node_spec '3 0 0' 'ℹ tests 3\nℹ pass 3\nℹ fail 0'
expect colours '2 0 0' '\033[1m      Tests\033[22m  \033[32m2 passed\033[39m (2)'
expect no_runner '0 0 0' 'Finished dev profile in 3s\n4 passed by'

echo "test result: $([ $failed -eq 0 ] && echo ok || echo FAILED). $passed passed; $failed failed; 0 ignored"
[ "$failed" -eq 0 ]
