// Files in an address, the one that is shown and those that it uses: `#files=…`, as JSON, deflated (RFC 1950: its sum tells whether it is whole) and in base 64 (RFC
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

/** The fragment that carries files; empty where it would be too long for an address. */
export async function fragmentOf(files) {
  const packed = base64(
    await through(new CompressionStream("deflate"), new TextEncoder().encode(JSON.stringify(files))),
  );
  return packed.length > LARGEST ? "" : `#files=${packed}`;
}

const isName = (name) => /^[^/\\"]{1,80}\.(frb|lut)$/i.test(name);

/**
 * The files that a fragment carries; null where it carries none.
 *
 * @returns {Promise<Record<string, string> | null>}
 */
export async function carriedBy(fragment) {
  const packed = new URLSearchParams(fragment.replace(/^#/, "")).get("files");
  if (packed === null) return null;
  const bytes = await through(new DecompressionStream("deflate"), bytesOf(packed));
  const files = Object.entries(JSON.parse(new TextDecoder("utf-8", { fatal: true }).decode(bytes)));
  const isWhole = files.length && files.every(([name, text]) => isName(name) && typeof text === "string");
  if (!isWhole) throw new Error("not files");
  return Object.fromEntries(files);
}
