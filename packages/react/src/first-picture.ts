/** Calls `onShown` once when a Canvas shows its splats: a complete cloud is drawn, and none is being read. */
export class FirstPicture {
  #onShown: (() => void) | null;
  #readings = 0;
  #isDrawn = false;

  constructor(onShown: () => void) {
    this.#onShown = onShown;
  }

  /** Call when a load begins; call the returned function when it ends. */
  read(): () => void {
    this.#readings++;
    return () => {
      this.#readings--;
      this.#notifyIfShown();
    };
  }

  /** Call when a complete cloud has been drawn. */
  drawn(): void {
    this.#isDrawn = true;
    this.#notifyIfShown();
  }

  /** Never calls `onShown` from now on: the Canvas is about to be replaced. */
  end(): void {
    this.#onShown = null;
  }

  #notifyIfShown(): void {
    if (!this.#isDrawn || this.#readings > 0) return;
    const onShown = this.#onShown;
    this.end();
    onShown?.();
  }
}
