#include "dvi/cli/run_program.h"

int main(int argc, char** argv) { return dvi::cli::run_program(argc, argv); }
