# What the end of a GoogleTest program's output looks like when it skipped all it has (no data, no EGL) and nothing failed.
# Failures are listed behind what was skipped: the end of the output must belong to the rule, since "[  PASSED  ] 0 tests"
# alone is also said where everything failed, and ctest lets a skip win over a failure.
set(SIGHTCELL_SKIPPED_ALL "\\[  PASSED  \\] 0 tests\\.\r?\n(\\[  SKIPPED \\] [^\n]*\n*)+$")
