/** Name of the first of the pieces that a `.bricks` file was cut into: see `open-url-pieces.ts`. */
export const FIRST_PIECE = /\.bricks\.000$/i;

/** Path of piece `index`, from the path of the first piece; '' gives the prefix of all paths. */
export function piecePath(firstPath: string, index: number | ''): string {
  return firstPath.replace(/000$/, index === '' ? '' : String(index).padStart(3, '0'));
}

/** Parts of a file that lie next to each other are one request of up to so many bytes. */
export const MOST_REQUEST_BYTES = 1 << 19;
