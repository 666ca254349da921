// peer_ppf: OpenCV's point-pair features on a data set; peer.h has its command line.
#include <memory>

#include "surface_search.h"

int main(int argc, char** argv) {
  using wirepose::bench::SurfaceSearch;
  return wirepose::bench::PeerMain(
      argc, argv, "peer_ppf", "OpenCV's surface_matching on a data set, for comparison",
      [](const auto& mesh, const auto& object) { return std::make_unique<SurfaceSearch>(mesh, object); });
}
