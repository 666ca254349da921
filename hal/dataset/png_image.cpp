#include "hal/dataset/png_image.h"

#include <png.h>

#include <cerrno>
#include <csetjmp>
#include <cstdio>
#include <cstring>
#include <memory>
#include <system_error>

namespace wirepose::dataset {
namespace {

constexpr png_uint_32 kMaxPngSide = 16384;
constexpr std::size_t kMaxFilePixels = std::size_t{64} << 20;

struct FileCloser {
  void operator()(std::FILE* file) const { std::fclose(file); }
};
using File = std::unique_ptr<std::FILE, FileCloser>;

// Where libpng leaves its message before it jumps back.
struct ErrorText {
  char text[160] = {};
};

void OnError(png_structp png, png_const_charp message) {
  auto* error = static_cast<ErrorText*>(png_get_error_ptr(png));
  std::snprintf(error->text, sizeof error->text, "%s", message);
  png_longjmp(png, 1);
}

void OnWarning(png_structp, png_const_charp) {}

enum class Kind { kGray8, kDepth16 };

// Owns libpng's read structures. Everything that may jump happens in the two methods, whose frames
// hold no object with a destructor: jumping over one would be undefined.
class Reader {
 public:
  Reader() : png_(png_create_read_struct(PNG_LIBPNG_VER_STRING, &error_, OnError, OnWarning)) {
    if (png_ != nullptr) info_ = png_create_info_struct(png_);
  }
  Reader(const Reader&) = delete;
  Reader& operator=(const Reader&) = delete;
  ~Reader() { png_destroy_read_struct(&png_, &info_, nullptr); }

  [[nodiscard]] bool ReadHeader(std::FILE* file) {
    if (png_ == nullptr || info_ == nullptr) return Fail("out of memory");
    if (setjmp(png_jmpbuf(png_)) != 0) return false;
    png_set_user_limits(png_, kMaxPngSide, kMaxPngSide);
    png_init_io(png_, file);
    png_read_info(png_, info_);
    width_ = static_cast<int>(png_get_image_width(png_, info_));
    height_ = static_cast<int>(png_get_image_height(png_, info_));
    bit_depth_ = png_get_bit_depth(png_, info_);
    color_type_ = png_get_color_type(png_, info_);
    return true;
  }

  // Prepares 8 bit grey or RGB, or 16 bit grey in the machine's byte order. False when it does not
  // come to that.
  [[nodiscard]] bool Prepare(Kind kind) {
    if (setjmp(png_jmpbuf(png_)) != 0) return false;
    if (color_type_ == PNG_COLOR_TYPE_PALETTE) png_set_palette_to_rgb(png_);
    if (color_type_ == PNG_COLOR_TYPE_GRAY && bit_depth_ < 8) png_set_expand_gray_1_2_4_to_8(png_);
    if ((color_type_ & PNG_COLOR_MASK_ALPHA) != 0) png_set_strip_alpha(png_);
    if (kind == Kind::kDepth16 && __BYTE_ORDER__ == __ORDER_LITTLE_ENDIAN__) png_set_swap(png_);
    (void)png_set_interlace_handling(png_);
    png_read_update_info(png_, info_);
    channels_ = png_get_channels(png_, info_);
    row_bytes_ = png_get_rowbytes(png_, info_);
    const std::size_t sample_bytes = kind == Kind::kDepth16 ? 2 : 1;
    return row_bytes_ == static_cast<std::size_t>(width_) * channels_ * sample_bytes;
  }

  // `rows` has one pointer an image row, each to row_bytes() bytes.
  [[nodiscard]] bool ReadRows(png_bytepp rows) {
    if (setjmp(png_jmpbuf(png_)) != 0) return false;
    png_read_image(png_, rows);
    png_read_end(png_, nullptr);
    return true;
  }

  [[nodiscard]] int width() const { return width_; }
  [[nodiscard]] int height() const { return height_; }
  [[nodiscard]] int bit_depth() const { return bit_depth_; }
  [[nodiscard]] int color_type() const { return color_type_; }
  [[nodiscard]] int channels() const { return channels_; }
  [[nodiscard]] std::size_t row_bytes() const { return row_bytes_; }
  [[nodiscard]] const char* error() const { return error_.text; }

 private:
  bool Fail(const char* text) {
    std::snprintf(error_.text, sizeof error_.text, "%s", text);
    return false;
  }

  ErrorText error_;
  png_structp png_ = nullptr;
  png_infop info_ = nullptr;
  int width_ = 0, height_ = 0, bit_depth_ = 0, color_type_ = 0, channels_ = 0;
  std::size_t row_bytes_ = 0;
};

ImageError Damaged(const std::filesystem::path& path, const std::string& what) {
  return {false, path.string() + ": " + what};
}

// Is this the kind of image that is wanted? Empty, or what is wrong and what to do.
std::string KindMismatch(const Reader& reader, Kind kind) {
  const bool is_16_bit = reader.bit_depth() == 16;
  if (kind == Kind::kGray8 && is_16_bit) {
    return "image has 16 bits a sample, 8 are needed; convert it to 8 bit grey";
  }
  if (kind == Kind::kDepth16 && (!is_16_bit || reader.color_type() != PNG_COLOR_TYPE_GRAY)) {
    return "depth image is not 16 bit grey; write depth as 16 bit PNG in units of depth_scale";
  }
  const auto pixels = static_cast<std::size_t>(reader.width()) * reader.height();
  if (pixels > kMaxFilePixels) return "image has more than 64 megapixels; scale it down";
  return {};
}

struct Decoded {
  int width = 0, height = 0, channels = 0;
  std::vector<std::uint8_t> bytes;
};

Result<Decoded, ImageError> Decode(const std::filesystem::path& path, Kind kind) {
  std::error_code error;
  if (!std::filesystem::exists(path, error)) {
    return unexpected(ImageError{true, path.string() + ": no such image file; check the data set"});
  }
  const File file(std::fopen(path.c_str(), "rb"));
  if (!file || std::filesystem::is_directory(path, error)) {
    return unexpected(Damaged(path, "cannot be opened; check the file permissions"));
  }
  Reader reader;
  const auto undecodable = [&](const char* place) {
    return unexpected(
        Damaged(path, std::string(place) + ": " + reader.error() + "; is it a complete PNG file? copy it again"));
  };
  if (!reader.ReadHeader(file.get())) return undecodable("header");
  const std::string mismatch = KindMismatch(reader, kind);
  if (!mismatch.empty()) return unexpected(Damaged(path, mismatch));
  if (!reader.Prepare(kind)) return undecodable("header");

  Decoded decoded{reader.width(), reader.height(), reader.channels(), {}};
  decoded.bytes.resize(reader.row_bytes() * static_cast<std::size_t>(decoded.height));
  std::vector<png_bytep> rows;
  for (int y = 0; y < decoded.height; ++y) {
    rows.push_back(decoded.bytes.data() + reader.row_bytes() * static_cast<std::size_t>(y));
  }
  if (!reader.ReadRows(rows.data())) return undecodable("pixels");
  return decoded;
}

// ITU-R BT.601 luma in 16 bit fixed point, rounded.
std::uint8_t Luma(const std::uint8_t* rgb) {
  return static_cast<std::uint8_t>((19595U * rgb[0] + 38470U * rgb[1] + 7471U * rgb[2] + 32768U) >> 16);
}

// As Reader: the only frame that libpng jumps over.
bool WriteRows(std::FILE* file, ErrorText& error, int width, int height, int bit_depth, png_bytepp rows) {
  png_structp png = png_create_write_struct(PNG_LIBPNG_VER_STRING, &error, OnError, OnWarning);
  png_infop info = png != nullptr ? png_create_info_struct(png) : nullptr;
  if (info == nullptr || setjmp(png_jmpbuf(png)) != 0) {
    png_destroy_write_struct(&png, &info);
    return false;
  }
  png_init_io(png, file);
  png_set_compression_level(png, 3);  // images with noise hardly get smaller above
  png_set_IHDR(png, info, static_cast<png_uint_32>(width), static_cast<png_uint_32>(height), bit_depth,
               PNG_COLOR_TYPE_GRAY, PNG_INTERLACE_NONE, PNG_COMPRESSION_TYPE_DEFAULT, PNG_FILTER_TYPE_DEFAULT);
  png_write_info(png, info);
  if (bit_depth == 16 && __BYTE_ORDER__ == __ORDER_LITTLE_ENDIAN__) png_set_swap(png);
  png_write_image(png, rows);
  png_write_end(png, nullptr);
  png_destroy_write_struct(&png, &info);
  return true;
}

template <typename T>
Result<void, std::string> WritePng(const std::filesystem::path& path, const BasicImageView<const T>& image) {
  // libpng asks for writable rows, so it gets a copy.
  const auto width = static_cast<std::size_t>(image.width);
  std::vector<T> pixels(width * static_cast<std::size_t>(image.height));
  std::vector<png_bytep> rows;
  for (int y = 0; y < image.height; ++y) {
    T* row = pixels.data() + static_cast<std::size_t>(y) * width;
    std::memcpy(row, image.row(y), width * sizeof(T));
    rows.push_back(reinterpret_cast<png_bytep>(row));
  }
  const auto failed = [&](const std::string& what) {
    return unexpected(path.string() + ": cannot be written: " + what + "; check folder, permissions and free space");
  };
  File file(std::fopen(path.c_str(), "wb"));
  if (!file) return failed(std::error_code(errno, std::generic_category()).message());
  ErrorText error;
  if (!WriteRows(file.get(), error, image.width, image.height, 8 * int{sizeof(T)}, rows.data())) {
    return failed(error.text);
  }
  if (std::fclose(file.release()) != 0) return failed("the disk refused the last bytes");
  return {};
}

}  // namespace

Result<GrayImage, ImageError> ReadGrayPng(const std::filesystem::path& path) {
  Result<Decoded, ImageError> decoded = Decode(path, Kind::kGray8);
  if (!decoded) return unexpected(decoded.error());
  GrayImage image{decoded->width, decoded->height, {}};
  if (decoded->channels == 1) {
    image.pixels = std::move(decoded->bytes);
    return image;
  }
  image.pixels = std::vector<std::uint8_t>(decoded->bytes.size() / 3);
  for (std::size_t i = 0; i < image.pixels.size(); ++i) {
    image.pixels[i] = Luma(&decoded->bytes[3 * i]);
  }
  return image;
}

Result<DepthImage, ImageError> ReadDepthPng(const std::filesystem::path& path) {
  const Result<Decoded, ImageError> decoded = Decode(path, Kind::kDepth16);
  if (!decoded) return unexpected(decoded.error());
  DepthImage image{decoded->width, decoded->height, {}};
  image.pixels.resize(decoded->bytes.size() / 2);
  std::memcpy(image.pixels.data(), decoded->bytes.data(), decoded->bytes.size());
  return image;
}

Result<void, std::string> WriteGrayPng(const std::filesystem::path& path, ImageView image) {
  return WritePng<std::uint8_t>(path, image);
}

Result<void, std::string> WriteDepthPng(const std::filesystem::path& path, BasicImageView<const std::uint16_t> image) {
  return WritePng<std::uint16_t>(path, image);
}

}  // namespace wirepose::dataset
