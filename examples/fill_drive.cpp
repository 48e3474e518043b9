// Removes the traffic from a drive with the library: fill_drive DRIVE OUT

#include <iostream>

#include <dvi/dvi.h>

int main(int argc, char** argv) try {
  if (argc != 3) throw dvi::UsageError("fill_drive DRIVE OUT");
  dvi::job::Job job;
  job.target = argv[1];
  job.out = argv[2];
  job.options.sample.sources = 2;  // any option of `dvi config dump`
  dvi::Progress progress(dvi::ProgressStyle::quiet);
  const dvi::result::RunReport report = dvi::run::run(job, progress);
  std::cout << report.brief(job.out) << "\n";
  return 0;
} catch (const std::exception& e) {
  std::cerr << e.what() << "\n";
  return 1;
}
