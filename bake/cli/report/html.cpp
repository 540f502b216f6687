#include "report/html.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "number_text.h"

namespace sightcell::cli {
namespace {

// Returns the length in bytes of the character that text begins with; 0 if it is not valid UTF-8.
std::size_t character_length(std::string_view text) {
  const auto byte = [&](std::size_t i) { return static_cast<unsigned char>(text[i]); };
  const unsigned char first = byte(0);
  if (first < 0x80) return 1;
  const std::size_t length = first >= 0xC2 && first < 0xE0   ? 2
                             : first >= 0xE0 && first < 0xF0 ? 3
                             : first >= 0xF0 && first < 0xF5 ? 4
                                                             : 0;
  if (length == 0 || length > text.size()) return 0;
  std::uint32_t code = first & (0xFFu >> (length + 1));
  for (std::size_t i = 1; i < length; ++i) {
    if ((byte(i) & 0xC0) != 0x80) return 0;
    code = code << 6 | (byte(i) & 0x3Fu);
  }
  constexpr std::uint32_t least[] = {0, 0, 0x80, 0x800, 0x10000};
  const bool surrogate = code >= 0xD800 && code < 0xE000, control = code >= 0x80 && code < 0xA0;
  return code < least[length] || code > 0x10FFFF || surrogate || control ? 0 : length;
}

}  // namespace

std::string escaped(std::string_view text) {
  std::string out;
  while (!text.empty()) {
    const std::size_t length = character_length(text);
    const char c = text[0];
    if (length == 0 || (length == 1 && (static_cast<unsigned char>(c) < 0x20 || c == 0x7F) && c != '\n' && c != '\t'))
      out += "\xEF\xBF\xBD";
    else if (c == '&')
      out += "&amp;";
    else if (c == '<')
      out += "&lt;";
    else if (c == '>')
      out += "&gt;";
    else if (c == '"')
      out += "&quot;";
    else if (c == '\'')
      out += "&#39;";
    else
      out += text.substr(0, length);
    text.remove_prefix(std::max<std::size_t>(length, 1));
  }
  return out;
}

std::string probability_text(double value) {
  if (!std::isfinite(value)) return "-";
  if (value == 0.0 || value >= 0.01) return fmt::format("{:.2g}", value);
  // "1.00e-04", without the zero of the exponent.
  std::string text = fmt::format("{:.2e}", value);
  if (const std::size_t zero = text.find("e-0"); zero != std::string::npos) text.erase(zero + 2, 1);
  return text;
}

std::string percent_text(double percent) {
  if (!std::isfinite(percent)) return "-";
  const double size = std::abs(percent);
  return size >= 10.0 || size == 0.0 ? fmt::format("{:.1f} %", percent) : fmt::format("{:.2g} %", percent);
}

std::string seconds_text(double seconds) {
  if (!std::isfinite(seconds)) return "-";
  return seconds < 10.0 ? fmt::format("{:.2g} s", seconds) : duration_text(seconds);
}

std::string bytes_text(std::uint64_t bytes) {
  return bytes < 1000 ? fmt::format("{} B", bytes) : size_text(static_cast<double>(bytes));
}

std::string command_html(std::string_view command) {
  std::string out = "<pre><code>";
  while (!command.empty()) {
    const std::string_view word = command.substr(0, command.find(' '));
    out += "<span>" + escaped(word) + "</span>";
    command.remove_prefix(word.size());
    if (!command.empty()) command.remove_prefix(1), out += ' ';
  }
  return out + "</code></pre>\n";
}

std::string table_of(const std::vector<named_value>& rows) {
  std::string out = "<table class=\"facts\">\n";
  for (const auto& [name, value] : rows)
    out += fmt::format("<tr><th scope=\"row\">{}</th><td>{}</td></tr>\n", escaped(name), value);
  return out + "</table>\n";
}

std::string bars_of(const std::vector<bar>& bars) {
  const auto length = [](const bar& b) { return std::isfinite(b.value) ? std::max(b.value, 0.0) : 0.0; };
  double longest = 0.0;
  for (const bar& b : bars) longest = std::max(longest, length(b));
  std::string out = "<div class=\"bars\">\n";
  for (const bar& b : bars)
    out += fmt::format(
        "<div class=\"bar\"><span class=\"name\">{}</span><svg class=\"line\" viewBox=\"0 0 100 10\" "
        "preserveAspectRatio=\"none\" aria-hidden=\"true\"><rect class=\"fill\" width=\"{:.2f}\" height=\"10\"/></svg>"
        "<span class=\"value\">{}</span></div>\n",
        escaped(b.name), longest > 0.0 ? 100.0 * length(b) / longest : 0.0, escaped(b.text));
  return out + "</div>\n";
}

}  // namespace sightcell::cli
