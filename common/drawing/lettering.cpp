#include "common/drawing/lettering.h"

#include <ft2build.h>

#include <cmath>
#include <memory>
#include <stdexcept>
#include FT_FREETYPE_H
#include FT_OUTLINE_H
#include FT_TRUETYPE_TABLES_H

namespace thalweg::lettering {
namespace {

constexpr double kUnit = 64.0;  // FreeType counts in 26.6 fixed point
constexpr char32_t kReplacement = 0xFFFD;

/// Decodes UTF-8 to code points; invalid bytes become U+FFFD.
std::u32string CodePoints(const std::string& text) {
  std::u32string points;
  for (std::size_t i = 0; i < text.size();) {
    const auto lead = static_cast<unsigned char>(text[i]);
    const std::size_t length = lead < 0x80       ? 1
                               : lead >> 5 == 6  ? 2
                               : lead >> 4 == 14 ? 3
                               : lead >> 3 == 30 ? 4
                                                 : 0;
    char32_t point = length == 1 ? lead : lead & (0x7FU >> length);
    bool good = length > 0 && i + length <= text.size();
    for (std::size_t k = 1; good && k < length; ++k) {
      const auto next = static_cast<unsigned char>(text[i + k]);
      good = next >> 6 == 2;
      point = point << 6 | (next & 0x3FU);
    }
    points += good ? point : kReplacement;
    i += good ? length : 1;
  }
  return points;
}

/// A font face, used by a single thread.
class Font {
 public:
  explicit Font(const char* file) {
    FT_Library library = nullptr;
    if (FT_Init_FreeType(&library) != 0) throw std::runtime_error("FreeType cannot be set up");
    library_.reset(library);
    FT_Face face = nullptr;
    if (FT_New_Face(library, file, 0, &face) != 0) {
      throw std::runtime_error(std::string(file) +
                               ": cannot be read; pictures need this font (Debian: fonts-dejavu-core)");
    }
    face_.reset(face);
    const auto* const os2 = static_cast<const TT_OS2*>(FT_Get_Sfnt_Table(face, FT_SFNT_OS2));
    if (os2 != nullptr && os2->sCapHeight > 0) {
      em_per_capital_ = static_cast<double>(face->units_per_EM) / os2->sCapHeight;
    }
  }

  /// Calls visit(glyph, pen) for each rendered letter, with the pen position [px] from the text's left end.
  /// @return The pen position at the end.
  template <class Visitor>
  double ForEachGlyph(const std::string& text, double capital, Visitor&& visit) {
    FT_Face face = face_.get();
    FT_Set_Char_Size(face, 0, std::lround(capital * em_per_capital_ * kUnit), 0, 0);  // 72 dpi: points are px
    double pen = 0.0;
    FT_UInt before = 0;
    for (const char32_t point : CodePoints(text)) {
      const FT_UInt glyph = FT_Get_Char_Index(face, point);
      FT_Vector kerning{};
      if (before != 0) FT_Get_Kerning(face, before, glyph, FT_KERNING_UNFITTED, &kerning);
      pen += static_cast<double>(kerning.x) / kUnit;
      if (FT_Load_Glyph(face, glyph, FT_LOAD_NO_HINTING) != 0) continue;
      visit(face->glyph, pen);
      pen += static_cast<double>(face->glyph->linearHoriAdvance) / 65536.0;
      before = glyph;
    }
    return pen;
  }

 private:
  struct Done {
    void operator()(FT_Library library) const { FT_Done_FreeType(library); }
    void operator()(FT_Face face) const { FT_Done_Face(face); }
  };
  std::unique_ptr<FT_LibraryRec_, Done> library_;
  std::unique_ptr<FT_FaceRec_, Done> face_;  // destroyed before the library
  double em_per_capital_ = 2048.0 / 1493.0;  // for DejaVu Sans
};

Font& FontOf(bool strong) {
  thread_local Font regular(THALWEG_FONT);
  thread_local Font bold(THALWEG_FONT_BOLD);
  return strong ? bold : regular;
}

/// Blends a color into the picture, using the bitmap as opacity.
void Blend(cv::Mat& picture, const FT_Bitmap& bitmap, int left, int top, const cv::Scalar& color) {
  for (int v = 0; v < static_cast<int>(bitmap.rows); ++v) {
    for (int u = 0; u < static_cast<int>(bitmap.width); ++u) {
      const int row = top + v;
      const int column = left + u;
      if (row < 0 || column < 0 || row >= picture.rows || column >= picture.cols) continue;
      const double cover = bitmap.buffer[v * bitmap.pitch + u] / 255.0;
      auto& pixel = picture.at<cv::Vec3b>(row, column);
      for (int k = 0; k < 3; ++k)
        pixel[k] = cv::saturate_cast<std::uint8_t>(std::lerp(pixel[k], color[k], cover));
    }
  }
}

}  // namespace

double WidthOf(const std::string& text, double capital, bool strong) {
  return FontOf(strong).ForEachGlyph(text, capital, [](FT_GlyphSlot, double) {});
}

void Draw(cv::Mat& picture, const std::string& text, const cv::Point2d& at, double capital,
          const cv::Scalar& color, bool strong) {
  FontOf(strong).ForEachGlyph(text, capital, [&](FT_GlyphSlot glyph, double pen) {
    const double x = at.x + pen;
    const int column = static_cast<int>(std::floor(x));
    FT_Outline_Translate(&glyph->outline, std::lround((x - column) * kUnit), 0);
    if (FT_Render_Glyph(glyph, FT_RENDER_MODE_NORMAL) != 0) return;
    Blend(picture, glyph->bitmap, column + glyph->bitmap_left,
          static_cast<int>(std::lround(at.y)) - glyph->bitmap_top, color);
  });
}

}  // namespace thalweg::lettering
