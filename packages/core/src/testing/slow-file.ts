/** A file that claims to have `bytes` and gives `parts`, the last of them after `beforeLast`. */
export function slowFile(
  name: string,
  bytes: Uint8Array<ArrayBuffer>,
  parts: readonly Uint8Array[],
  beforeLast = async () => {},
): File {
  const file = new File([bytes], name);
  const left = [...parts];
  file.stream = () =>
    new ReadableStream(
      {
        async pull(controller) {
          if (left.length === 1) await beforeLast();
          const part = left.shift();
          if (part) controller.enqueue(part.slice());
          else controller.close();
        },
      },
      { highWaterMark: 0 },
    );
  return file;
}
