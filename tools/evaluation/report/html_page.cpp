#include "tools/evaluation/report/html_page.h"

#include <array>
#include <stdexcept>

namespace wirepose::evaluation {
namespace {

using Json = nlohmann::ordered_json;

std::string EscapeHtml(std::string_view text) {
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

// JSON within a script element: "</script>" or "<!--" in a text would end or change the element.
std::string JsonInScript(const Json& data) {
  std::string out;
  for (const char c : data.dump(-1, ' ', false, Json::error_handler_t::replace)) {
    if (c == '<') {
      out += "\\u003c";
    } else {
      out += c;
    }
  }
  return out;
}

struct Part {
  std::string_view mark;
  std::string text;
};

// Replaces each mark once, from the start of the template on; what was put in is not searched again.
template <std::size_t kCount>
std::string Fill(std::string_view page, const std::array<Part, kCount>& parts) {
  std::string out;
  for (const Part& part : parts) {
    const std::size_t at = page.find(part.mark);
    if (at == std::string_view::npos) throw std::logic_error("page.html lacks " + std::string(part.mark));
    out += page.substr(0, at);
    out += part.text;
    page.remove_prefix(at + part.mark.size());
  }
  return out += page;
}

}  // namespace

std::string MakePage(std::string_view title, const Json& data) {
  const PageFiles& files = ThePageFiles();
  // A JSON text keeps only what is UTF-8, which the title must be as well.
  const std::string clean = Json::parse(Json(title).dump(-1, ' ', false, Json::error_handler_t::replace));
  return Fill(files.html, std::array<Part, 4>{{{"{{title}}", EscapeHtml(clean)},
                                               {"{{style}}", std::string(files.css)},
                                               {"{{data}}", JsonInScript(data)},
                                               {"{{script}}", std::string(files.script)}}});
}

}  // namespace wirepose::evaluation
