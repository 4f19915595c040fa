type HostResource = GPUTexture | number | null | undefined;

/** A bind group with a host's textures: most hosts hand over the same ones in every frame. */
export class HostGroup {
  #group: GPUBindGroup | null = null;
  #of: readonly HostResource[] = [];

  /** Returns the last group, or makes one if that was made for other textures or layers of them. */
  for(resources: readonly HostResource[], make: () => GPUBindGroup): GPUBindGroup {
    if (!this.#group || resources.some((each, i) => each !== this.#of[i])) {
      this.#group = make();
      this.#of = resources;
    }
    return this.#group;
  }

  /** Call when anything else that it binds has changed. */
  clear(): void {
    this.#group = null;
  }
}
