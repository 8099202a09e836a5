/* PNG by libpng, TIFF by libtiff. */
#include "resample/pixels.h"
#include "store/store.h"
#include <math.h>

PetscBool EqmIsTiff(const char *file)
{
  return (PetscBool)(EqmHasSuffix(file, ".tif") || EqmHasSuffix(file, ".tiff"));
}

const char *EqmPixelsMissing(const char *file)
{
#ifndef EQM_HAVE_TIFF
  if (EqmIsTiff(file)) return "libtiff (Debian: libtiff-dev)";
#endif
#ifndef EQM_HAVE_PNG
  if (!EqmIsTiff(file)) return "libpng (Debian: libpng-dev)";
#endif
  return NULL;
}

#ifdef EQM_HAVE_PNG
#include <png.h>

static void Append(png_structp png, png_bytep bytes, png_size_t count)
{
  EqmAtomicWrite((EqmAtomicFile *)png_get_io_ptr(png), bytes, count);
}

static void Flush(png_structp png)
{
  (void)png;
}

/* Least and largest value of each channel; what is no number does not count. */
static void Range(const EqmPixels *pixels, PetscReal *low, PetscReal *high)
{
  for (int k = 0; k < pixels->channels; k++) {
    low[k] = PETSC_MAX_REAL;
    high[k] = -PETSC_MAX_REAL;
    for (size_t i = (size_t)k; i < (size_t)pixels->size * (size_t)pixels->size * (size_t)pixels->channels;
         i += (size_t)pixels->channels) {
      if (isnan(pixels->values[i])) continue;
      low[k] = PetscMin(low[k], pixels->values[i]);
      high[k] = PetscMax(high[k], pixels->values[i]);
    }
    if (low[k] > high[k]) low[k] = high[k] = 0.;
  }
}

/* The range in words, so that the numbers can be had back. */
static void Describe(png_structp png, png_infop info, const EqmPixels *pixels, const PetscReal *low,
                     const PetscReal *high)
{
  char key[3][16] = {"quantity", "least", "largest"}, text[3][256] = {"", "", ""};
  png_text entry[3] = {{0}};

  (void)snprintf(text[0], sizeof(text[0]), "%s", pixels->quantity);
  for (int k = 0; k < pixels->channels; k++) {
    const size_t a = strlen(text[1]), b = strlen(text[2]);

    (void)snprintf(text[1] + a, sizeof(text[1]) - a, "%s%.17g", k ? " " : "", (double)low[k]);
    (void)snprintf(text[2] + b, sizeof(text[2]) - b, "%s%.17g", k ? " " : "", (double)high[k]);
  }
  for (int i = 0; i < 3; i++)
    entry[i] = (png_text){.compression = PNG_TEXT_COMPRESSION_NONE, .key = key[i], .text = text[i]};
  png_set_text(png, info, entry, 3);
}

/* A row of 16-bit numbers, the high byte first. */
static void FillRow(const EqmPixels *pixels, int row, const PetscReal *low, const PetscReal *high, png_bytep bytes)
{
  const int n = pixels->size * pixels->channels;

  for (int i = 0; i < n; i++) {
    const int k = i % pixels->channels;
    const PetscReal value = pixels->values[(size_t)n * (size_t)row + (size_t)i], range = high[k] - low[k];
    const unsigned sample = isnan(value) || range <= 0. ? 0u : (unsigned)floor(65535. * (value - low[k]) / range + .5);

    bytes[2 * i] = (png_byte)(sample >> 8);
    bytes[2 * i + 1] = (png_byte)(sample & 255u);
  }
}

PetscErrorCode EqmPixelsToPng(const EqmPixels *pixels, EqmAtomicFile *file, char *message, size_t length)
{
  static const int color[] = {0, PNG_COLOR_TYPE_GRAY, PNG_COLOR_TYPE_GRAY_ALPHA, PNG_COLOR_TYPE_RGB,
                              PNG_COLOR_TYPE_RGBA};
  png_structp png = png_create_write_struct(PNG_LIBPNG_VER_STRING, NULL, NULL, NULL);
  png_infop info = png ? png_create_info_struct(png) : NULL;
  png_bytep bytes = malloc(2 * (size_t)pixels->size * (size_t)pixels->channels);
  PetscReal low[4], high[4];

  if (!info || !bytes || setjmp(png_jmpbuf(png))) {
    (void)snprintf(message, length, "cannot write '%.1000s': libpng refuses", file->path);
    free(bytes);
    if (png) png_destroy_write_struct(&png, &info);
    return EQM_ERR_IO;
  }
  Range(pixels, low, high);
  png_set_write_fn(png, file, Append, Flush);
  png_set_IHDR(png, info, (png_uint_32)pixels->size, (png_uint_32)pixels->size, 16, color[pixels->channels],
               PNG_INTERLACE_NONE, PNG_COMPRESSION_TYPE_DEFAULT, PNG_FILTER_TYPE_DEFAULT);
  Describe(png, info, pixels, low, high);
  png_write_info(png, info);
  for (int row = pixels->size - 1; row >= 0; row--) {
    FillRow(pixels, row, low, high, bytes);
    png_write_row(png, bytes);
  }
  png_write_end(png, info);
  free(bytes);
  png_destroy_write_struct(&png, &info);
  return 0;
}
#else
PetscErrorCode EqmPixelsToPng(const EqmPixels *pixels, EqmAtomicFile *file, char *message, size_t length)
{
  (void)pixels;
  (void)snprintf(message, length, "cannot write '%.1000s' without libpng", file->path);
  return EQM_ERR_USAGE;
}
#endif

#ifdef EQM_HAVE_TIFF
#include <tiffio.h>

PetscErrorCode EqmPixelsToTiff(const EqmPixels *pixels, const char *path, char *message, size_t length)
{
  const int n = pixels->size * pixels->channels;
  float *row = malloc(sizeof(float) * (size_t)n);
  TIFF *tiff = TIFFOpen(path, "w");
  int fine = row && tiff;

  fine = fine && TIFFSetField(tiff, TIFFTAG_IMAGEWIDTH, pixels->size) &&
         TIFFSetField(tiff, TIFFTAG_IMAGELENGTH, pixels->size) &&
         TIFFSetField(tiff, TIFFTAG_SAMPLESPERPIXEL, pixels->channels) &&
         TIFFSetField(tiff, TIFFTAG_BITSPERSAMPLE, 32) &&
         TIFFSetField(tiff, TIFFTAG_SAMPLEFORMAT, SAMPLEFORMAT_IEEEFP) &&
         TIFFSetField(tiff, TIFFTAG_PLANARCONFIG, PLANARCONFIG_CONTIG) &&
         TIFFSetField(tiff, TIFFTAG_PHOTOMETRIC, pixels->channels >= 3 ? PHOTOMETRIC_RGB : PHOTOMETRIC_MINISBLACK) &&
         TIFFSetField(tiff, TIFFTAG_IMAGEDESCRIPTION, pixels->quantity) && TIFFSetField(tiff, TIFFTAG_ROWSPERSTRIP, 16);
  for (int i = 0; i < pixels->size && fine; i++) {
    const PetscReal *const values = pixels->values + (size_t)n * (size_t)(pixels->size - 1 - i);

    for (int k = 0; k < n; k++) row[k] = (float)values[k];
    fine = TIFFWriteScanline(tiff, row, (uint32_t)i, 0) == 1;
  }
  if (tiff) {
    fine = TIFFFlush(tiff) && fine;
    TIFFClose(tiff);
  }
  free(row);
  if (!fine) (void)snprintf(message, length, "cannot write '%.1000s': libtiff refuses", path);
  return fine ? 0 : EQM_ERR_IO;
}
#else
PetscErrorCode EqmPixelsToTiff(const EqmPixels *pixels, const char *path, char *message, size_t length)
{
  (void)pixels;
  (void)snprintf(message, length, "cannot write '%.1000s' without libtiff", path);
  return EQM_ERR_USAGE;
}
#endif
