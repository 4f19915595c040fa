import { resolveAccuracy } from '../data/accuracy/accuracy.ts';
import { given } from '../data/given.ts';
import { onAbort } from '../data/on-abort.ts';
import { type CloudPrecision, ownShPrecision } from '../data/packing/precision.ts';
import type { ReadOptions } from '../io/sources/splat-source.ts';

/** `signal` cancels the claim until it is met; `onProgress` reports reading, if any. */
export type HoldOptions = Pick<ReadOptions, 'signal' | 'onProgress'>;

/** Planes are made until `signal` aborts. */
export interface MakeOptions extends Pick<ReadOptions, 'onProgress'> {
  readonly signal: AbortSignal;
}

interface LeasesContext {
  /** Name of the cloud, for messages. */
  readonly name: string;
  /** Whether the cloud's file has a palette for its harmonics. */
  readonly hasPalette: boolean;
  /** Frees all planes that `claims` does not need. */
  readonly keepOnly: (claims: readonly CloudPrecision[]) => void;
  /** Adds the planes of a precision to the cloud. If it rejects, it adds none. */
  readonly make: (precision: CloudPrecision, options: MakeOptions) => Promise<void>;
}

/** A claim that has not been met yet. */
interface PendingClaim {
  readonly wanted: CloudPrecision;
  readonly cancellation: AbortController;
}

/** A claim on precisions of one cloud: the planes stay until it is changed or released. */
export class CloudLease {
  readonly #leases: CloudLeases;
  #met: Promise<void> = Promise.resolve();

  /** @internal Use `cloud.hold`. */
  constructor(leases: CloudLeases) {
    this.#leases = leases;
  }

  /** Resolves when the cloud holds the latest claim; else rejects: see `SplatCloud.hold`. */
  get met(): Promise<void> {
    return this.#met;
  }

  /**
   * Claims `precision` instead. The old claim stands until the new one is met, and remains if that
   * fails. Cancels a claim of this lease that is still pending.
   *
   * @returns the new `met`.
   */
  change(precision: CloudPrecision, options: HoldOptions = {}): Promise<void> {
    return this.#noteMet(this.#leases.claim(this, precision, options));
  }

  /** Claims `precision` in addition to the lease's other claims; otherwise like `change`. */
  add(precision: CloudPrecision, options: HoldOptions = {}): Promise<void> {
    return this.#noteMet(this.#leases.claim(this, precision, options, { isAdded: true }));
  }

  /**
   * Gives up all claims, cancels a pending one, and frees the planes that no other lease claims.
   * `change` claims again.
   */
  release(): void {
    this.#leases.release(this);
  }

  #noteMet(met: Promise<void>): Promise<void> {
    this.#met = met;
    // Some holders never read `met`: its rejection must not count as unhandled.
    met.catch(() => {});
    return met;
  }
}

/**
 * All leases of one cloud. This class alone decides which planes the cloud holds:
 *
 * - A cloud holds the planes that its leases claim, and no others.
 * - `own` is the cloud's own lease. It claims the uploaded precision until the engine changes it:
 *   for `requestPrecision`, for the engine's accuracy, and for the settings chosen to meet a
 *   target. A holder whose leases cover everything that shows the cloud releases it.
 * - There is always a claim, so that there is always something to draw: when the last lease is
 *   released, its claims pass to `own`.
 * - A new claim changes nothing until all of its planes exist. Until then it protects the planes that
 *   it needs among the held ones, even if another holder releases them.
 */
export class CloudLeases {
  readonly own = new CloudLease(this);
  readonly #context: LeasesContext;
  /** Met claims; leases without any are not listed. Never empty. */
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

  /** Makes `lease` claim a precision, besides its others if `isAdded`, else in their place. */
  async claim(
    lease: CloudLease,
    precision: CloudPrecision,
    options: HoldOptions,
    { isAdded = false } = {},
  ): Promise<void> {
    const { geometryPrecision, shPrecision } = given(precision, {}, 'precision');
    const { signal, onProgress } = given(options);
    if (this.#ended) throw this.#ended;
    signal?.throwIfAborted();
    resolveAccuracy({ geometryPrecision, shPrecision });
    const { name, make, hasPalette } = this.#context;
    const wanted = {
      geometryPrecision,
      shPrecision: hasPalette ? shPrecision : ownShPrecision(shPrecision),
    };
    this.#cancel(lease, `A later request for ${name} replaced this one.`);
    const cancellation = new AbortController();
    const pending = { wanted, cancellation };
    this.#pending.set(lease, pending);
    const ignoreSignal = onAbort(signal, () => cancellation.abort(signal?.reason));
    try {
      await make(wanted, { signal: cancellation.signal, onProgress });
      cancellation.signal.throwIfAborted();
      const others = isAdded ? (this.#claims.get(lease) ?? []) : [];
      this.#claims.set(lease, [...others.filter((claim) => !isSame(claim, wanted)), wanted]);
    } finally {
      ignoreSignal();
      if (this.#pending.get(lease) === pending) this.#pending.delete(lease);
      this.#freeUnclaimed();
    }
  }

  release(lease: CloudLease): void {
    this.#cancel(lease, `The lease was released before ${this.#context.name} held its planes.`);
    const claims = this.#claims.get(lease);
    if (!claims) return;
    this.#claims.delete(lease);
    if (this.#claims.size === 0) this.#claims.set(this.own, claims);
    this.#freeUnclaimed();
  }

  /** Rejects pending and later claims with `reason`: the planes are gone, or cannot be made. */
  end(reason: Error): void {
    this.#ended ??= reason;
    for (const { cancellation } of this.#pending.values()) cancellation.abort(reason);
  }

  #cancel(lease: CloudLease, message: string): void {
    const pending = this.#pending.get(lease);
    this.#pending.delete(lease);
    pending?.cancellation.abort(new DOMException(message, 'AbortError'));
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
