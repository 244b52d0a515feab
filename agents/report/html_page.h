#pragma once

#include <filesystem>
#include <nlohmann/json.hpp>
#include <opencv2/core.hpp>
#include <string>
#include <string_view>

namespace gusset {

/// A page of its own, to be opened without a network: assets/report/NAME.html with everything that
/// it asks for inlined. `{{file NAME}}` stands for a file of assets/report, `{{chart.js}}` for the
/// charting library (Debian: libjs-chart.js), `{{data}}` for `data` as JSON.
///
/// What `data` holds cannot leave the element it stands in; the page's script has it from there and
/// must put it on the page as text.
/// @throws InputError naming the file that is missing, and the package that holds it.
std::string FillPage(const std::string& name, const nlohmann::ordered_json& data);

/// Base 64 (RFC 4648, section 4).
std::string Base64(std::string_view bytes);

/// `data:` address of bytes. @param type such as "video/mp4".
std::string DataUri(const std::string& type, std::string_view bytes);

/// `data:` address of a picture file as JPEG, at most `width_px` wide.
/// @throws InputError naming the file if it is no picture.
std::string PictureUri(const std::filesystem::path& file, int width_px);

}  // namespace gusset
