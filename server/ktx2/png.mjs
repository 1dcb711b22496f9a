// Decodes the PNG files that Standin writes: 8 bits, RGBA, not interlaced. Whatever else there is, is refused.
import { inflateSync } from "node:zlib";

/** The PNG specification's predictor of that name: whichever of left, above and upper left is nearest to left + above - upper left. */
function paeth(left, above, upperLeft) {
  const guess = left + above - upperLeft;
  const [dl, da, du] = [Math.abs(guess - left), Math.abs(guess - above), Math.abs(guess - upperLeft)];
  if (dl <= da && dl <= du) return left;
  return da <= du ? above : upperLeft;
}

const PREDICTORS = [() => 0, (left) => left, (left, above) => above, (left, above) => (left + above) >> 1, paeth];

function unfiltered(rows, width, height) {
  const stride = 4 * width, rgba = new Uint8Array(stride * height);
  for (let y = 0; y < height; ++y) {
    const start = y * (stride + 1), predict = PREDICTORS[rows[start]];
    for (let i = 0; i < stride; ++i) {
      const at = y * stride + i, left = i >= 4 ? rgba[at - 4] : 0, above = y > 0 ? rgba[at - stride] : 0;
      rgba[at] = rows[start + 1 + i] + predict(left, above, i >= 4 && y > 0 ? rgba[at - stride - 4] : 0);
    }
  }
  return rgba;
}

/** {width, height, data}: RGBA8, rows from the top. */
export function decodePng(bytes) {
  if (bytes.toString("latin1", 1, 4) !== "PNG") throw new Error("an image that is no PNG");
  let width = 0, height = 0;
  const packed = [];
  for (let at = 8; at + 12 <= bytes.length; at += 12 + bytes.readUInt32BE(at)) {
    const type = bytes.toString("latin1", at + 4, at + 8), content = bytes.subarray(at + 8, at + 8 + bytes.readUInt32BE(at));
    if (type === "IHDR") {
      [width, height] = [content.readUInt32BE(0), content.readUInt32BE(4)];
      const [depth, colour, , , interlaced] = content.subarray(8);
      if (depth !== 8 || colour !== 6 || interlaced !== 0) throw new Error("a PNG that is not 8-bit RGBA without interlacing");
    }
    if (type === "IDAT") packed.push(content);
  }
  return { width, height, data: unfiltered(inflateSync(Buffer.concat(packed)), width, height) };
}
