# shellcheck shell=bash
# Reads what the test runners say of themselves at the end of their run.
#
# count_tests LOG prints "PASSED FAILED SKIPPED", summed over every closing line
# of nextest, cargo test, vitest and Node's own runner in LOG; a log without
# such a line gives "0 0 0". deploy/count_test.sh holds a sample of each.
count_tests() {
    sed 's/\x1b\[[0-9;]*[A-Za-z]//g; s/\r$//' "$1" | awk '
        # "3 passed, 1 failed (1 slow)": adds each number to what its word means.
        function add(text,    i, n, parts, number, word) {
            gsub(/\([^)]*\)/, "", text)
            n = split(text, parts, /[,;|]/)
            for (i = 1; i <= n; i++) {
                if (!match(parts[i], /[0-9]+ +[a-z]+/)) continue
                number = substr(parts[i], RSTART, RLENGTH)
                word = number
                sub(/^[0-9]+ +/, "", word)
                tally(word, number + 0)
            }
        }
        function tally(word, number) {
            if (word ~ /^pass/) passed += number
            else if (word ~ /^(fail|cancel|timed|exec)/) failed += number
            else if (word ~ /^(skip|ignore|todo)/) skipped += number
        }
        # nextest: "     Summary [   1.2s] 5 tests run: 4 passed, 1 failed, 2 skipped"
        /^ *Summary \[/ { sub(/^.*tests? run:/, ""); add($0); next }
        # cargo test: "test result: ok. 4 passed; 0 failed; 1 ignored; ..."
        /^test result: / { sub(/^test result: [A-Za-z]+\. /, ""); add($0); next }
        # vitest: "      Tests  1 failed | 4 passed | 2 skipped (7)"
        /^ *Tests  +[0-9]/ { sub(/^ *Tests +/, ""); add($0); next }
        # Node: "# pass 4" or, for people, "ℹ pass 4"
        /^(#|ℹ) (pass|fail|cancelled|skipped|todo) [0-9]+$/ { tally($2, $3 + 0); next }
        END { print passed + 0, failed + 0, skipped + 0 }'
}
