import { resolveAccuracy } from '../accuracy/accuracy.ts';
import type { ReadOptions } from '../io/splat-source.ts';
import type { CloudPrecision } from '../packing/precision.ts';

/** `signal` calls the claim off until it is met; `onProgress` reports how far reading has come, where anything is read. */
export type HoldOptions = Pick<ReadOptions, 'signal' | 'onProgress'>;

/** How planes are made: until `signal` aborts. */
export interface MakeOptions extends Pick<ReadOptions, 'onProgress'> {
  readonly signal: AbortSignal;
}

interface LeasesContext {
  /** The cloud's, for messages. */
  readonly name: string;
  /** Frees all planes but those of `claims`. */
  readonly keepOnly: (claims: readonly CloudPrecision[]) => void;
  /** Adds the planes of a precision to those that the cloud holds. Adds none where it rejects. */
  readonly make: (precision: CloudPrecision, options: MakeOptions) => Promise<void>;
}

/** A claim that is not met yet. */
interface PendingClaim {
  readonly wanted: CloudPrecision;
  readonly calledOff: AbortController;
}

/** A claim on precisions of one cloud: their planes stay on the GPU until the claim is changed or released. */
export class CloudLease {
  readonly #leases: CloudLeases;
  #met: Promise<void> = Promise.resolve();

  /** @internal Use `cloud.hold`. */
  constructor(leases: CloudLeases) {
    this.#leases = leases;
  }

  /** Resolves when the cloud holds what was claimed last; rejects where it cannot: see `SplatCloud.hold`. */
  get met(): Promise<void> {
    return this.#met;
  }

  /**
   * Claims `precision` instead. The old claim stands until the new one is met, and stays where that fails. A claim of this
   * lease that is still pending is called off.
   *
   * @returns as `met`.
   */
  change(precision: CloudPrecision, options: HoldOptions = {}): Promise<void> {
    return this.#noteMet(this.#leases.claim(this, precision, options));
  }

  /** Claims `precision` as well; otherwise as `change`. */
  add(precision: CloudPrecision, options: HoldOptions = {}): Promise<void> {
    return this.#noteMet(this.#leases.claim(this, precision, { ...options, isAdded: true }));
  }

  /**
   * Gives up all claims, and frees the planes that nobody else claims. A pending claim is called off. `change` claims anew.
   */
  release(): void {
    this.#leases.release(this);
  }

  #noteMet(met: Promise<void>): Promise<void> {
    this.#met = met;
    // Holders who need not know never look at it.
    met.catch(() => {});
    return met;
  }
}

/**
 * All leases of one cloud. This is the one place that decides which planes it holds:
 *
 * - A cloud holds the planes that its leases claim, and no others.
 * - `own` is the cloud's own lease. It claims what was uploaded, until the engine changes it: for `requestPrecision`, for the
 *   engine's accuracy, and for what was chosen to meet a wish. A holder that speaks for everything that shows the cloud
 *   releases it.
 * - There is always a claim, so that there is always something to draw: what the last lease claims when it is released
 *   passes to `own`.
 * - A new claim changes nothing until all of its planes are there. Meanwhile it protects those that it has found: what it
 *   needs and another holder releases stays.
 */
export class CloudLeases {
  readonly own = new CloudLease(this);
  readonly #context: LeasesContext;
  /** Claims that are met; a lease without any is not listed. Never empty. */
  readonly #claims = new Map<CloudLease, readonly CloudPrecision[]>();
  readonly #pending = new Map<CloudLease, PendingClaim>();
  #ended: Error | null = null;

  constructor(uploaded: CloudPrecision, context: LeasesContext) {
    this.#context = context;
    this.#claims.set(this.own, [uploaded]);
  }

  /** See `SplatCloud.hold`. */
  hold(precision: CloudPrecision, options?: HoldOptions): CloudLease {
    const lease = new CloudLease(this);
    lease.change(precision, options);
    return lease;
  }

  /** Makes `lease` claim a precision: in place of its other claims, or beside them where `isAdded`. */
  async claim(
    lease: CloudLease,
    { geometryPrecision, shPrecision }: CloudPrecision,
    { signal, onProgress, isAdded = false }: HoldOptions & { readonly isAdded?: boolean },
  ): Promise<void> {
    if (this.#ended) throw this.#ended;
    signal?.throwIfAborted();
    const wanted = { geometryPrecision, shPrecision };
    resolveAccuracy(wanted);
    const { name, make } = this.#context;
    this.#callOff(lease, `A later request for ${name} took the place of this one.`);
    const calledOff = new AbortController();
    const pending = { wanted, calledOff };
    this.#pending.set(lease, pending);
    const onAbort = () => calledOff.abort(signal?.reason);
    signal?.addEventListener('abort', onAbort, { once: true });
    try {
      await make(wanted, { signal: calledOff.signal, onProgress });
      calledOff.signal.throwIfAborted();
      const others = isAdded ? (this.#claims.get(lease) ?? []) : [];
      this.#claims.set(lease, [...others.filter((claim) => !isSame(claim, wanted)), wanted]);
    } finally {
      signal?.removeEventListener('abort', onAbort);
      if (this.#pending.get(lease) === pending) this.#pending.delete(lease);
      this.#freeUnclaimed();
    }
  }

  release(lease: CloudLease): void {
    this.#callOff(lease, `The lease was released before ${this.#context.name} held what it claims.`);
    const claims = this.#claims.get(lease);
    if (!claims) return;
    this.#claims.delete(lease);
    if (this.#claims.size === 0) this.#claims.set(this.own, claims);
    this.#freeUnclaimed();
  }

  /** The planes are gone, or nothing can be made any more: pending and later claims reject with `reason`. */
  end(reason: Error): void {
    this.#ended ??= reason;
    for (const { calledOff } of this.#pending.values()) calledOff.abort(reason);
  }

  #callOff(lease: CloudLease, message: string): void {
    const pending = this.#pending.get(lease);
    this.#pending.delete(lease);
    pending?.calledOff.abort(new DOMException(message, 'AbortError'));
  }

  #freeUnclaimed(): void {
    if (this.#ended) return;
    const wanted = Array.from(this.#pending.values(), (pending) => pending.wanted);
    this.#context.keepOnly([...[...this.#claims.values()].flat(), ...wanted]);
  }
}

function isSame(a: CloudPrecision, b: CloudPrecision): boolean {
  return a.geometryPrecision === b.geometryPrecision && a.shPrecision === b.shPrecision;
}
