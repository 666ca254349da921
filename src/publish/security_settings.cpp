#include "publish/security_settings.h"

#include <dlfcn.h>

#include <filesystem>

namespace wirepose {
namespace {

namespace fs = std::filesystem;

std::string Escaped(const std::string& text) {
  std::string out;
  for (const char c : text) {
    switch (c) {
      case '&':
        out += "&amp;";
        break;
      case '<':
        out += "&lt;";
        break;
      case '>':
        out += "&gt;";
        break;
      case '"':
        out += "&quot;";
        break;
      default:
        out += c;
    }
  }
  return out;
}

// Debian keeps the plug-ins in a folder beside the library; elsewhere the dynamic linker finds them by name.
std::string PluginPath(const std::string& name) {
  Dl_info info{};
  if (dladdr(reinterpret_cast<const void*>(&dds_create_participant), &info) != 0 && info.dli_fname != nullptr) {
    const fs::path folder = fs::path(info.dli_fname).parent_path();
    for (const fs::path& place : {folder / "libddsc0debian", folder}) {
      const fs::path file = place / ("lib" + name + ".so");
      std::error_code error;
      if (fs::exists(file, error)) return file.string();
    }
  }
  return name;
}

std::string Library(const std::string& plugin, const std::string& function) {
  return "<Library path=\"" + Escaped(PluginPath("dds_security_" + plugin)) + "\" initFunction=\"init_" + function +
         "\" finalizeFunction=\"finalize_" + function + "\"/>";
}

std::string File(const std::string& element, const std::string& path) {
  return "<" + element + ">file:" + Escaped(path) + "</" + element + ">";
}

}  // namespace

std::string SecuritySettings(const SecurityFiles& files) {
  return R"(<CycloneDDS xmlns="https://cdds.io/config"><Domain Id="any"><Security><Authentication>)" +
         Library("auth", "authentication") + File("IdentityCA", files.identity_ca) +
         File("IdentityCertificate", files.certificate) + File("PrivateKey", files.private_key) +
         "</Authentication><AccessControl>" + Library("ac", "access_control") +
         File("PermissionsCA", files.permissions_ca) + File("Governance", files.governance) +
         File("Permissions", files.permissions) + "</AccessControl><Cryptographic>" + Library("crypto", "crypto") +
         "</Cryptographic></Security></Domain></CycloneDDS>";
}

}  // namespace wirepose
