import { escaped } from '../ui/html.ts';

/** A file of a scene that a page holds. */
export interface HeldFile {
  /** Its name, or its path from the folder of a scene in several files. */
  readonly path: string;
  readonly bytes: Blob;
  /** Where it lies, from the page; by default the page itself holds its bytes. */
  readonly address?: string;
}

/** A part of a scene, as one of the viewer's sources. */
export interface HeldPart {
  readonly title: string;
  /** Name of the built-in scene that it is; null for other files. */
  readonly builtin: string | null;
  readonly files: readonly HeldFile[];
}

export interface PageContents {
  /** Name of the scene. */
  readonly title: string;
  /** The query of an address that shows this view. */
  readonly view: string;
  /** Background of the picture as a CSS colour; null for the theme's background. */
  readonly background: string | null;
  /** Address of an image to show until there is a picture. */
  readonly poster?: string;
  readonly parts: readonly HeldPart[];
}

/** The meta elements with the view and the poster; elements with parts and files of the scene. */
export const VIEW_NAME = 'websplatter-view';
export const POSTER_NAME = 'websplatter-poster';
export const PART_SELECTOR = '[data-part]';
export const FILE_SELECTOR = '[data-path]';

/** A multiple of 3: the base64 texts of pieces can then be joined without padding between them. */
const PIECE_BYTES = 3 * 2 ** 20;

export interface WritePageOptions {
  readonly signal: AbortSignal;
  /** Called with the part that has been written, 0…1. */
  readonly onPart: (part: number) => void;
}

/**
 * Writes a scene into the page.
 *
 * @param template text of `scene-page.html` as it is built.
 * @throws the signal's reason once that is aborted.
 */
export async function writePage(
  template: string,
  { title, view, background, poster = '', parts }: PageContents,
  { signal, onPart }: WritePageOptions,
): Promise<Blob> {
  const style = background === null ? '' : ` style="--scene-background: ${escaped(background)}"`;
  const head = template
    .replace('<html', () => `<html${style}`)
    .replace(
      /<title>.*?<\/title>/s,
      () => `<title>${escaped(title)}</title>\n${meta(VIEW_NAME, view)}${meta(POSTER_NAME, poster)}`,
    );
  // The scripts before it may have such words too.
  const end = head.lastIndexOf('</body>');
  const totalBytes = parts
    .flatMap(({ files }) => files.filter(({ address }) => address === undefined))
    .reduce((sum, { bytes }) => sum + bytes.size, 0);
  let writtenBytes = 0;
  const pieces: string[] = [head.slice(0, end)];
  for (const part of parts) {
    const builtin = part.builtin === null ? '' : ` data-builtin="${escaped(part.builtin)}"`;
    pieces.push(`<div hidden data-part="${escaped(part.title)}"${builtin}>\n`);
    for (const { path, bytes, address } of part.files) {
      if (address !== undefined) {
        pieces.push(`<a data-path="${escaped(path)}" href="${escaped(address)}"></a>\n`);
        continue;
      }
      pieces.push(`<script type="application/octet-stream" data-path="${escaped(path)}">`);
      for (let at = 0; at < bytes.size; at += PIECE_BYTES) {
        const piece = bytes.slice(at, at + PIECE_BYTES);
        pieces.push(await base64Of(piece));
        signal.throwIfAborted();
        writtenBytes += piece.size;
        onPart(writtenBytes / totalBytes);
      }
      pieces.push('</script>\n');
    }
    pieces.push('</div>\n');
  }
  return new Blob([...pieces, head.slice(end)], { type: 'text/html' });
}

function meta(name: string, content: string): string {
  return content && `<meta name="${name}" content="${escaped(content)}">`;
}

async function base64Of(bytes: Blob): Promise<string> {
  const binary = new Uint8Array(await bytes.arrayBuffer());
  if ('toBase64' in binary) return (binary as Uint8Array & { toBase64(): string }).toBase64();
  let text = '';
  // Calls take no more arguments than some ten thousand.
  for (let at = 0; at < binary.length; at += 0x3000)
    text += btoa(String.fromCharCode(...binary.subarray(at, at + 0x3000)));
  return text;
}
