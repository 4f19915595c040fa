/** A range of bytes of a file. */
export interface FilePart {
  readonly offset: number;
  readonly bytes: number;
}

export function endOf({ offset, bytes }: FilePart): number {
  return offset + bytes;
}
