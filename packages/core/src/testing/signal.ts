/** A promise, and the function that resolves it. */
export function signalOf(): { readonly when: Promise<void>; readonly give: () => void } {
  let give = () => {};
  const when = new Promise<void>((resolve) => {
    give = resolve;
  });
  return { when, give };
}
