// Rows of an image on several threads.
#ifndef WIREPOSE_SIM_PARALLEL_H_
#define WIREPOSE_SIM_PARALLEL_H_

#include <atomic>
#include <thread>
#include <vector>

namespace wirepose::sim {

// Calls work(row) once for each row in [0, rows), on `threads` threads in any order; returns when
// all are done.
template <typename Work>
void ForEachRow(int rows, int threads, const Work& work) {
  std::atomic<int> next{0};
  const auto run = [&] {
    for (int row = next++; row < rows; row = next++) work(row);
  };
  std::vector<std::thread> others;
  for (int i = 1; i < threads; ++i) others.emplace_back(run);
  run();
  for (std::thread& thread : others) thread.join();
}

}  // namespace wirepose::sim

#endif  // WIREPOSE_SIM_PARALLEL_H_
