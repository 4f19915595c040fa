import { flippedPoint } from '../camera/flip.ts';
import type { LengthScale, LengthUnit, Ruler } from '../state/inspecting.ts';
import { makeEdit, replacement } from '../state/make-edit.ts';
import { withKept } from '../state/messages.ts';
import { subtract } from '../state/vec3.ts';
import type { EditHistory } from './edit-history.ts';
import type { InspectTools } from './inspect-tools.ts';
import { lengthScaleKey, readLengthScale, scaleFrom } from './length-scale.ts';
import { pickSplat } from './pick-splat.ts';

export interface RulersOptions extends InspectTools {
  /**
   * Returns storage, such as `localStorage`. Called before each access, because browsers may forbid
   * it.
   */
  readonly storage: () => Pick<Storage, 'getItem' | 'setItem' | 'removeItem'>;
}

/** In scene units. */
export function rulerLength({ ends }: Ruler): number {
  return Math.hypot(...subtract(ends[1], ends[0]));
}

/** Measures distances between points of the scene, in scene units or by a known length. */
export class Rulers {
  readonly #options: RulersOptions;
  readonly #history: EditHistory;
  #given = 0;

  constructor(options: RulersOptions, history: EditHistory) {
    this.#options = options;
    this.#history = history;
  }

  /** Sets a ruler's next end to the splat at `xPart`, `yPart` from the image's top left. */
  async markAt(xPart: number, yPart: number): Promise<void> {
    const { store, update } = this.#options;
    const pick = await pickSplat(this.#options, xPart, yPart);
    if (!pick) {
      update({ problem: 'No splat is drawn there.' });
      return;
    }
    const { isFlipped, inspecting } = store.getState();
    const { rulerStart, rulers } = inspecting;
    const point = isFlipped ? flippedPoint(pick.point) : pick.point;
    if (!rulerStart) update({ rulerStart: point, problem: null });
    else {
      const ruler: Ruler = { id: ++this.#given, ends: [rulerStart, point] };
      update({ rulerStart: null });
      this.#history.edit('ruler', { rulers: [...rulers, ruler] });
    }
  }

  remove(ruler: Ruler): void {
    const { rulers } = this.#options.store.getState().inspecting;
    this.#history.edit('removal of a ruler', { rulers: rulers.filter((each) => each !== ruler) });
  }

  /** Discards a ruler that has only one end. */
  forgetStart(): void {
    this.#options.update({ rulerStart: null });
  }

  /**
   * Sets a ruler's true length, which scales all lengths of the scene. Returns whether the length
   * is valid.
   */
  calibrate(ruler: Ruler, length: number, unit: LengthUnit): boolean {
    const scale = scaleFrom(rulerLength(ruler), length, unit);
    if (!scale) return false;
    this.#setScale(scale);
    return true;
  }

  /** Returns to lengths in scene units. */
  forgetScale(): void {
    this.#setScale(null);
  }

  #setScale(scale: LengthScale | null): void {
    const { store, update } = this.#options;
    const now = () => store.getState().inspecting.scale;
    const show = (shown: LengthScale | null) => {
      update({ scale: shown });
      this.#keep(shown && JSON.stringify(shown));
    };
    makeEdit(store, replacement('known length', scale, now, show));
  }

  /** Loads the stored scale of the current scene. */
  readScale(): void {
    const { store, storage, update } = this.#options;
    const contentKey = store.getState().scene?.contentKey;
    let text: string | null = null;
    try {
      text = contentKey === undefined ? null : storage().getItem(lengthScaleKey(contentKey));
    } catch {
      // Some windows have no storage.
    }
    const scale = readLengthScale(text);
    if (scale) update({ scale });
  }

  #keep(text: string | null): void {
    const { store, storage } = this.#options;
    const contentKey = store.getState().scene?.contentKey;
    if (contentKey === undefined) return;
    let failure: unknown = null;
    try {
      if (text === null) storage().removeItem(lengthScaleKey(contentKey));
      else storage().setItem(lengthScaleKey(contentKey), text);
    } catch (error) {
      failure = error;
    }
    store.setState((state) => withKept(state, 'known length', failure));
  }
}
