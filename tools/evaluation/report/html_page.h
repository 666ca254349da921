// The report's page: a template with its style and script, and the data put into it.
#ifndef WIREPOSE_TOOLS_EVALUATION_REPORT_HTML_PAGE_H_
#define WIREPOSE_TOOLS_EVALUATION_REPORT_HTML_PAGE_H_

#include <nlohmann/json.hpp>
#include <string>
#include <string_view>

namespace wirepose::evaluation {

// page.html, page.css and the scripts, in the order in which they run; built into the program.
struct PageFiles {
  std::string_view html, css, script;
};
const PageFiles& ThePageFiles();

// One self-contained HTML file: style, script and `data` stand inside, nothing is loaded. Whatever text the data holds
// stays data: it cannot end its script element, and the page's script only ever sets it as text. Bytes that are not
// UTF-8 become U+FFFD. O(size).
std::string MakePage(std::string_view title, const nlohmann::ordered_json& data);

}  // namespace wirepose::evaluation

#endif  // WIREPOSE_TOOLS_EVALUATION_REPORT_HTML_PAGE_H_
