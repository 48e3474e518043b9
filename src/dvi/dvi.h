#pragma once

// The library in one header: everything that a program of your own needs to check a drive, fill it, and score the result. After
// `cmake --install`, `find_package(dvi)` gives the target dvi::commands; examples/fill_drive.cpp is a whole program.
//
// All of it throws dvi::InputError where the data are wrong, dvi::UsageError where an option is, dvi::Interrupted after SIGINT
// or SIGTERM if dvi::catch_interrupts() was called.

#include "dvi/commands/check.h"            // IWYU pragma: export
#include "dvi/commands/evaluate_result.h"  // IWYU pragma: export
#include "dvi/commands/import_fill.h"      // IWYU pragma: export
#include "dvi/commands/label_scans.h"      // IWYU pragma: export
#include "dvi/core/error.h"                // IWYU pragma: export
#include "dvi/core/progress.h"             // IWYU pragma: export
#include "dvi/core/threads.h"              // IWYU pragma: export
#include "dvi/exports/exporter.h"          // IWYU pragma: export
#include "dvi/metrics/evaluate.h"          // IWYU pragma: export
#include "dvi/run/make_map.h"              // IWYU pragma: export
#include "dvi/run/run.h"                   // IWYU pragma: export
