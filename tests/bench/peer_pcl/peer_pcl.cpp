// peer_pcl: PCL's feature-based alignment on a data set; peer.h has its command line.
#include <pcl/console/print.h>

#include <memory>

#include "prerejective_search.h"

int main(int argc, char** argv) {
  pcl::console::setVerbosityLevel(pcl::console::L_ALWAYS);  // a pose that finds no cloud near it is no error
  using wirepose::bench::PrerejectiveSearch;
  return wirepose::bench::PeerMain(
      argc, argv, "peer_pcl", "PCL's SampleConsensusPrerejective on a data set, for comparison",
      [](const auto& mesh, const auto& object) { return std::make_unique<PrerejectiveSearch>(mesh, object); });
}
