#pragma once

namespace dvi::cli {

/// Runs the command of a command line, whose first argument is the name of the program, and returns the exit code. Sets up the
/// process for it: memory, and signals, which end the command instead of the process.
int run_program(int argc, char** argv);

}  // namespace dvi::cli
