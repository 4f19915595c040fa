import type { AccuracySettings } from '@websplatter/core';
import { shallow } from 'zustand/vanilla/shallow';
import type { Comparison } from '../state/accuracy.ts';
import type { Edit } from '../state/history.ts';
import { recordEdit } from '../state/make-edit.ts';
import type { ViewerState } from '../state/store.ts';
import { type PictureSetting, settingFields } from '../state/undone.ts';
import { upAxisOf } from '../state/up-axis.ts';
import type { PanelProps } from './viewer.ts';

/** All settings of the picture, as they are brought back. */
function settingsOf(state: ViewerState) {
  const { choices, effects, text } = state.requested;
  return {
    effects: { choices, effects, text },
    up: settingFields('up', state),
    look: state.look,
    accuracy: settingFields('accuracy', state),
    detail: settingFields('detail', state),
    comparison: settingFields('comparison', state),
    viewMode: settingFields('viewMode', state),
  } satisfies Record<PictureSetting, object>;
}

type Settings = ReturnType<typeof settingsOf>;
/** Of the look only what was changed: a saved view may have changed the rest meanwhile. */
type Changed = Partial<Omit<Settings, 'look'>> & { readonly look?: Partial<Settings['look']> };

function show({ store, viewer }: PanelProps, { effects, up, look, ...fields }: Changed): void {
  if (up) viewer.camera.setUpAxis(upAxisOf(up));
  if (look) viewer.camera.setLook(look);
  if (effects) store.setState(({ requested }) => ({ requested: { ...requested, ...effects } }));
  for (const values of Object.values(fields)) store.setState(values);
  viewer.followSettings();
}

/**
 * Calls `act`, which a person has asked for. What it changes of the picture's settings is an edit;
 * without a change there is none.
 *
 * @param name what it changes, as in "Undo background".
 * @param gesture successive changes of one gesture are undone together; null for a change of its own.
 */
export function editPicture(panel: PanelProps, name: string, act: () => void, gesture: unknown = null): void {
  const { store } = panel;
  const now = () => settingsOf(store.getState());
  const first = now();
  act();
  let before = changed(first, now());
  if (Object.keys(before).length === 0) return;
  let after = alike(before, now());
  const edit: Edit = {
    name,
    do() {
      before = alike(after, now());
      show(panel, after);
    },
    undo() {
      after = alike(before, now());
      show(panel, before);
    },
  };
  recordEdit(store, edit, gesture);
}

/** The settings of `before` that are others now. */
function changed(before: Settings, now: Settings): Changed {
  const { look, ...others } = before;
  const entries = Object.entries(others).filter(
    ([name, value]) => !shallow(value, now[name as keyof Settings]),
  );
  const looks = Object.entries(look).filter(([name, value]) => value !== now.look[name as keyof typeof look]);
  return { ...Object.fromEntries(entries), ...(looks.length > 0 && { look: Object.fromEntries(looks) }) };
}

/** The settings of `now` that `settings` names. */
function alike(settings: Changed, now: Settings): Changed {
  const entries = Object.keys(settings).map((name) => [name, now[name as keyof Settings]]);
  const looks = Object.keys(settings.look ?? {}).map((name) => [
    name,
    now.look[name as keyof Settings['look']],
  ]);
  return { ...Object.fromEntries(entries), ...(settings.look && { look: Object.fromEntries(looks) }) };
}

/** Draws with settings that a person has chosen. @param gesture as for `editPicture`. */
export function setAccuracy(panel: PanelProps, settings: AccuracySettings, gesture?: object): void {
  editPicture(panel, 'accuracy', () => panel.viewer.setAccuracy(settings), gesture);
}

/** Shows a comparison that a person has chosen; null ends it. */
export function compare(panel: PanelProps, comparison: Comparison | null): void {
  editPicture(panel, 'comparison', () => panel.viewer.compare(comparison));
}
