// A file in an address: `#file=NAME&text=…`, deflated (RFC 1950: its sum tells whether it is whole) and in base 64 (RFC
// 4648, section 5). What stands behind # is never sent to a server.

const LARGEST = 60_000; // characters of an address that programs pass on

const through = async (stream, bytes) =>
  new Uint8Array(await new Response(new Blob([bytes]).stream().pipeThrough(stream)).arrayBuffer());

const BINARY = 0x8000; // characters that are made at once

function base64(bytes) {
  let text = "";
  for (let k = 0; k < bytes.length; k += BINARY) text += String.fromCharCode(...bytes.subarray(k, k + BINARY));
  return btoa(text).replace(/\+/g, "-").replace(/\//g, "_").replace(/=+$/, "");
}

const bytesOf = (text) =>
  Uint8Array.from(atob(text.replace(/-/g, "+").replace(/_/g, "/")), (each) => each.charCodeAt(0));

/** The fragment that carries a file; empty where it would be too long for an address. */
export async function fragmentOf(file, text) {
  const packed = base64(await through(new CompressionStream("deflate"), new TextEncoder().encode(text)));
  const found = new URLSearchParams({ file, text: packed }).toString();
  return found.length > LARGEST ? "" : `#${found}`;
}

/**
 * The file that a fragment carries; null where it carries none.
 *
 * @returns {Promise<{ file: string, text: string } | null>}
 */
export async function carriedBy(fragment) {
  const said = new URLSearchParams(fragment.replace(/^#/, ""));
  const packed = said.get("text");
  if (packed === null) return null;
  const bytes = await through(new DecompressionStream("deflate"), bytesOf(packed));
  return { file: said.get("file") ?? "", text: new TextDecoder("utf-8", { fatal: true }).decode(bytes) };
}
