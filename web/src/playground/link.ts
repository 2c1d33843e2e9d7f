/** Links that hold a whole set-up: "#toml=…&colour=psi6", the TOML text deflated (RFC 1951) and in base64url. */

export interface LinkContent {
  /** The text of a set-up, or the name of a scene; one of them where a link holds anything. */
  readonly toml?: string;
  readonly scene?: string;
  /** How it is shown; what is left out is usual. */
  readonly colour?: string;
  readonly grid?: boolean;
  /** Infinity: as fast as it can. */
  readonly stepsPerSecond?: number;
}

const UNLIMITED = "unlimited";

/** The bytes behind a stream. Throws RangeError where there are more than `most`. */
async function through(
  bytes: BufferSource,
  stream: CompressionStream | DecompressionStream,
  most = Infinity,
): Promise<Uint8Array<ArrayBuffer>> {
  const writer = stream.writable.getWriter();
  // Both sides report bad data; that of the reader is awaited.
  writer.write(bytes).catch(() => {});
  writer.close().catch(() => {});
  const reader = stream.readable.getReader();
  const parts: Uint8Array<ArrayBuffer>[] = [];
  let length = 0;
  for (let part = await reader.read(); !part.done; part = await reader.read()) {
    length += part.value.length;
    if (length > most) {
      await reader.cancel();
      throw new RangeError(`more than ${most} bytes`);
    }
    parts.push(part.value as Uint8Array<ArrayBuffer>);
  }
  return new Uint8Array(await new Blob(parts).arrayBuffer());
}

function toBase64Url(bytes: Uint8Array): string {
  let letters = "";
  for (const byte of bytes) letters += String.fromCharCode(byte);
  return btoa(letters).replaceAll("+", "-").replaceAll("/", "_").replace(/=+$/, "");
}

function fromBase64Url(text: string): Uint8Array<ArrayBuffer> {
  const letters = atob(text.replaceAll("-", "+").replaceAll("_", "/"));
  return Uint8Array.from(letters, (letter) => letter.charCodeAt(0));
}

/** The part of an address from "#" on. */
export async function encodeLink(content: LinkContent): Promise<string> {
  const parts: string[] = [];
  if (content.scene !== undefined) parts.push(`scene=${encodeURIComponent(content.scene)}`);
  if (content.toml !== undefined) {
    parts.push(
      `toml=${toBase64Url(await through(new TextEncoder().encode(content.toml), new CompressionStream("deflate-raw")))}`,
    );
  }
  if (content.colour !== undefined) parts.push(`colour=${encodeURIComponent(content.colour)}`);
  if (content.grid === true) parts.push("grid=1");
  if (content.stepsPerSecond !== undefined) {
    parts.push(`speed=${content.stepsPerSecond === Infinity ? UNLIMITED : content.stepsPerSecond}`);
  }
  return `#${parts.join("&")}`;
}

/** Longer texts are no set-up: a small link must not unpack to something that fills the memory. */
const MOST_BYTES = 1_000_000;

/** What encodeLink() has put into a link. Throws Error for a link that is damaged. */
export async function decodeLink(hash: string): Promise<LinkContent> {
  const parts = new URLSearchParams(hash.replace(/^#/, ""));
  const packed = parts.get("toml");
  const scene = parts.get("scene");
  const colour = parts.get("colour");
  const speed = parts.get("speed") === UNLIMITED ? Infinity : Number(parts.get("speed"));
  return {
    ...(packed === null ? {} : { toml: await unpack(packed) }),
    ...(scene === null ? {} : { scene }),
    ...(colour === null ? {} : { colour }),
    ...(parts.get("grid") === "1" ? { grid: true } : {}),
    ...(speed > 0 ? { stepsPerSecond: speed } : {}),
  };
}

async function unpack(packed: string): Promise<string> {
  try {
    return new TextDecoder().decode(await through(fromBase64Url(packed), new DecompressionStream("deflate-raw"), MOST_BYTES));
  } catch (error) {
    if (error instanceof RangeError)
      throw new Error("the set-up in this link is longer than a megabyte; open it as a file with gridlock run");
    throw new Error("the set-up in this link is damaged; copy the whole link, from “#toml=” to its last letter");
  }
}
