// Impostors with textures that stay compressed on the GPU: the PNG atlases of an impostors.glb become KTX2 files (KHR_texture_basisu).
//
//     node to_ktx2.mjs IMPOSTORS.glb OUT.glb [--quality 0..4]
//
// An engine transcodes Basis Universal's UASTC blocks to what its device has (BC7, ASTC, ETC2), at 16 bytes for 4 x 4 texels: a quarter of
// RGBA8. Masks must survive, or there are holes: each page is decoded again, and one changed texel is an error (exit 1, nothing written).
// One level of detail, as impostors are drawn with nearest-texel sampling. Prints what it did as JSON.
import { readFileSync, renameSync, writeFileSync } from "node:fs";
import { pathToFileURL } from "node:url";
import { NodeBasisEncoder } from "ktx2-encoder";
import { readGlb, viewBytes, writeGlb } from "./glb.mjs";
import { decodePng } from "./png.mjs";

const EXTENSION = "KHR_texture_basisu";
const RGBA32 = 13; // the transcoder's number for uncompressed texels
const OPAQUE_FROM = 128; // the materials' cutoff is 0.5

/** What a page looks like once it is decoded. */
export function decodeKtx2(basis, bytes) {
  const file = new basis.KTX2File(bytes);
  try {
    const decoded = new Uint8Array(4 * file.getWidth() * file.getHeight());
    if (!file.isValid() || !file.startTranscoding() || !file.transcodeImage(decoded, 0, 0, 0, RGBA32, 0, -1, -1)) throw new Error("a KTX2 file that does not decode");
    return decoded;
  } finally {
    file.close();
    file.delete();
  }
}

/** {opaque, alphaChanges, squaredError} of decoded against original texels; colours count where they are seen. */
export function loss(original, decoded) {
  const sum = { opaque: 0, alphaChanges: 0, squaredError: 0 };
  for (let i = 0; i < original.length; i += 4) {
    const seen = original[i + 3] >= OPAQUE_FROM;
    if (seen !== decoded[i + 3] >= OPAQUE_FROM) ++sum.alphaChanges;
    if (!seen) continue;
    ++sum.opaque;
    for (let c = 0; c < 3; ++c) sum.squaredError += (original[i + c] - decoded[i + c]) ** 2;
  }
  return sum;
}

async function encodePage(encoder, png, quality) {
  const page = decodePng(png);
  const place = `page of ${page.width} x ${page.height} texels`;
  if (page.width % 4 !== 0 || page.height % 4 !== 0) throw new Error(`${place}: ${EXTENSION} asks for multiples of 4`);
  const options = { isUASTC: true, uastcLDRQualityLevel: quality, generateMipmap: false, imageDecoder: async () => page };
  const ktx2 = await encoder.encode(png, options);
  const { opaque, alphaChanges, squaredError } = loss(page.data, decodeKtx2(await encoder.init(), ktx2));
  if (alphaChanges > 0) throw new Error(`${place}: ${alphaChanges} texels changed their mask`);
  return { ktx2: Buffer.from(ktx2), png: png.length, texels: page.width * page.height, opaque, squaredError };
}

/** Textures take their images by way of the extension; there is no PNG to fall back on, so it is required. */
function referToKtx2(gltf) {
  for (const image of gltf.images ?? []) image.mimeType = "image/ktx2";
  for (const texture of gltf.textures ?? []) {
    texture.extensions = { ...texture.extensions, [EXTENSION]: { source: texture.source } };
    delete texture.source;
  }
  for (const list of ["extensionsUsed", "extensionsRequired"]) gltf[list] = [...new Set([...(gltf[list] ?? []), EXTENSION])];
}

function summary(pages, seconds) {
  const sum = (key) => pages.reduce((total, page) => total + page[key], 0);
  const squaredError = sum("squaredError");
  return {
    pages: pages.length, png_bytes: sum("png"), ktx2_bytes: pages.reduce((total, page) => total + page.ktx2.length, 0), gpu_bytes: sum("texels"),
    alpha_exact: true, opaque_psnr_db: squaredError > 0 ? 10 * Math.log10((255 ** 2 * 3 * sum("opaque")) / squaredError) : null, seconds,
  };
}

/** {bytes, report} of a GLB's bytes. */
export async function toKtx2(bytes, quality = 1) {
  const start = performance.now();
  const glb = readGlb(bytes);
  const encoder = new NodeBasisEncoder();
  const pages = [], exchanged = new Map();
  for (const image of glb.gltf.images ?? []) {
    pages.push(await encodePage(encoder, viewBytes(glb, image.bufferView), quality));
    exchanged.set(image.bufferView, pages.at(-1).ktx2);
  }
  if (pages.length > 0) referToKtx2(glb.gltf);
  return { bytes: writeGlb(glb, exchanged), report: summary(pages, (performance.now() - start) / 1000) };
}

async function main([input, output, flag, level = "1"]) {
  const quality = Number(level);
  if (!input || !output || (flag !== undefined && flag !== "--quality") || ![0, 1, 2, 3, 4].includes(quality)) {
    process.stderr.write("usage: to_ktx2.mjs IMPOSTORS.glb OUT.glb [--quality 0..4]\n");
    return 2;
  }
  console.log = () => {}; // the encoder talks
  try {
    const { bytes, report } = await toKtx2(readFileSync(input), quality);
    writeFileSync(`${output}.part`, bytes);
    renameSync(`${output}.part`, output);
    process.stdout.write(`${JSON.stringify(report)}\n`);
    return 0;
  } catch (error) {
    process.stderr.write(`${input}: ${error.message}\n`);
    return 1;
  }
}

if (import.meta.url === pathToFileURL(process.argv[1]).href) process.exitCode = await main(process.argv.slice(2));
