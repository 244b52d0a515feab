#pragma once

namespace gusset {

/// The whole program: parses, runs one subcommand, reports. Never throws.
/// @returns the exit code: 0 success, 2 bad arguments or input (one line on stderr), 1 failed run.
int RunCommandLine(int argc, char** argv);

}  // namespace gusset
