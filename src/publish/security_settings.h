// DDS Security as Cyclone's configuration wants it.
#ifndef WIREPOSE_PUBLISH_SECURITY_SETTINGS_H_
#define WIREPOSE_PUBLISH_SECURITY_SETTINGS_H_

#include <string>

#include "publish/bus.h"

namespace wirepose {

// A fragment of Cyclone's XML: authentication, access control and encryption by Cyclone's plug-ins, which are looked for
// beside libddsc.
std::string SecuritySettings(const SecurityFiles& files);

}  // namespace wirepose

#endif  // WIREPOSE_PUBLISH_SECURITY_SETTINGS_H_
