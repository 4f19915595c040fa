import {
  type Camera,
  InvalidArgumentError,
  orthographicCamera,
  perspectiveCamera,
  type SceneFraming,
} from '@websplatter/core';
import { verticalFov } from '@websplatter/kit/vertical-fov';
import { FIRST_LOOK, type Look } from '../state/camera.ts';
import { focused, type LookAt, lookAt, type OrbitPose, poseFromLookAt } from '../state/orbit-pose.ts';
import type { CameraSnapshot, KeptView, LinkedCamera, ViewedCamera } from '../state/saved-view.ts';
import type { ViewerStore } from '../state/store.ts';
import {
  nearestUpAxis,
  oppositeAxis,
  type UpAxis,
  upAxisOf,
  uprightnessOf,
  upVector,
} from '../state/up-axis.ts';
import { dot, subtract, type Vec3 } from '../state/vec3.ts';
import {
  besideCovered,
  type Covered,
  CoveredGlide,
  freeAspect,
  isSameCovered,
  NOTHING_COVERED,
} from './covered.ts';
import { flippedPoint, turnedPose } from './flip.ts';
import { depthRange, firstPose, fitDistance, framedPose, parallelView } from './framing.ts';
import type { GamepadSticks } from './gamepad-motion.ts';
import { OrbitControls, type OrbitControlsOptions } from './orbit-controls.ts';
import type { orbitNear } from './orbit-near.ts';
import type { Sphere } from './scene-bounds.ts';

/** The scene's own cameras, with the code for orbiting on from them, which few scenes need. */
export interface OwnCameras {
  readonly at: (aspect: number) => Readonly<Record<string, Camera>>;
  readonly orbitNear: typeof orbitNear;
}

/** The scene data that its camera needs. */
export interface CameraSubject {
  /** Bounds of the scene without stray splats; unflipped. */
  readonly sphere: Sphere;
  /** Bounds of all splats, unflipped. */
  readonly extent: Sphere;
  /** First view of a scene that defines none; null: framed by `sphere`. Unflipped. */
  readonly framing: SceneFraming | null;
  /** Sphere around most of its detail, unflipped; null if it has changed since it was framed. */
  readonly detail: Sphere | null;
  /** The view that the scene defines. */
  readonly firstView:
    | (LookAt & { readonly fovYDegrees: number; readonly near: number; readonly far: number })
    | null;
  /**
   * Named cameras whose exact images matter, for an image of this aspect ratio. Orbiting need not
   * reach them: they may be orthographic, off-centre or mirrored. Null for other scenes.
   */
  readonly ownCameras: OwnCameras | null;
  /** Whether y mostly points down in files of the scene's format, as in computer vision. */
  readonly isUpsideDown: boolean;
  /** Whether its files differ from those at its first view: opened again, they have another one. */
  readonly hasOtherFiles?: boolean;
}

/** Moves the camera before each frame; returns whether another frame is needed. */
export type CameraMotion = (elapsedMs: number) => boolean;

/** From this many radii away, a scene is smaller than a pixel. */
const FARTHEST_RADII = 1e4;
/**
 * Stray splats may be farther away, but within the range where float64 still resolves moves at the
 * scene.
 */
const FARTHEST_STRAY_RADII = 1e9;

/**
 * Least framed radius as a fraction of a scene's distance from the origin: a centimetre at 10,000
 * km.
 */
const LEAST_RADIUS_PART = 1e-9;

const NOT_TURNED = { shown: null, poses: new Map<UpAxis, OrbitPose>() };

/** Directions closer than this, about 8°, count as the same up. */
const SAME_UP_COSINE = 0.99;

/**
 * The camera of the current scene: an orbit, or one of the scene's own cameras until the view is
 * moved.
 */
export class ViewCamera {
  readonly controls: OrbitControls;
  /** Used by gamepads instead of orbiting, as in flight; null while orbiting. */
  steering: ((sticks: GamepadSticks, elapsedS: number) => void) | null = null;
  readonly #store: ViewerStore;
  readonly #onChange: () => void;
  readonly #isMotionReduced: () => boolean;
  readonly #glide = new CoveredGlide();
  #covered = NOTHING_COVERED;
  #subject: CameraSubject | null = null;
  #first: CameraSnapshot | null = null;
  /** See `CameraSnapshot.home`; the controls' home is its pose for the present axis. */
  #home: KeptView | null = null;
  /** The pose with each axis that was up, while the view was not moved: there and back is the same picture. */
  #turned: { readonly shown: OrbitPose | null; readonly poses: Map<UpAxis, OrbitPose> } = NOT_TURNED;
  #motion: CameraMotion | null = null;
  /** Whether the user chose the up axis or the view: then a better first view is not shown. */
  #isViewChosen = false;

  constructor(store: ViewerStore, options: OrbitControlsOptions) {
    this.#store = store;
    this.#onChange = options.onChange;
    this.#isMotionReduced = options.isMotionReduced ?? (() => false);
    this.controls = new OrbitControls(options);
  }

  /** Sets the scene that the camera looks at; the pose stays until `showFirstView` or `restore`. */
  follow(subject: CameraSubject): void {
    const sphere = withLeastRadius(subject.sphere);
    const detail = subject.detail && withLeastRadius(subject.detail);
    this.#subject = { ...subject, sphere, detail };
    this.controls.distanceRange = { min: this.subjectRadius * 1e-3, max: sphere.radius * 100 };
    this.#store.setState({ firstUp: firstUpOf(subject) });
  }

  /** First view of the scene; null before there is one, and while its files are others. */
  get first(): CameraSnapshot | null {
    return this.#subject?.hasOtherFiles ? null : this.#first;
  }

  showFirstView(): void {
    const subject = this.#subject;
    if (!subject) return;
    this.#placeFirst(subject);
    this.#first = this.snapshot();
  }

  /**
   * Shows the scene with a linked camera. Home is the scene's first view, or the linked one on pages
   * with only the picture: it is what their readers were sent.
   */
  showLinked(camera: LinkedCamera): void {
    this.showFirstView();
    const subject = this.#subject;
    if (!subject) return;
    // A scene's own cameras are shown unchanged.
    if (subject.ownCameras) this.#showOwnCamera(camera.cameraIndex);
    else if (upAxisOf(camera) !== upAxisOf(this.#store.getState())) this.setUpAxis(upAxisOf(camera));
    const { cameraIndex, isFlipped, isZUp, home } = this.snapshot();
    const isSent = !this.#store.getState().hasInterface && !subject.ownCameras;
    const shown = { ...camera, cameraIndex, isFlipped, isZUp };
    this.restore({ ...shown, home: isSent ? shown : home });
    // While the view stays, home improves as more of the scene is loaded.
    this.#isViewChosen = this.controls.isHome;
  }

  #placeFirst(subject: CameraSubject): void {
    const { firstView, ownCameras } = subject;
    this.#isViewChosen = false;
    this.#takeUprightness();
    this.#store.setState({ cameraIndex: 0 });
    if (ownCameras) {
      this.#showOwnCamera(0);
      return;
    }
    this.setLook({ fovDegrees: firstView?.fovYDegrees ?? FIRST_LOOK.fovDegrees });
    this.#showHome(firstView ? poseFromLookAt(firstView) : this.#firstPose(subject));
  }

  /** Shows a pose with the present axis and look, and makes it home. */
  #showHome(pose: OrbitPose): void {
    this.controls.setPose(pose);
    this.#home = this.keptView;
  }

  /**
   * Call it after `follow`, when more of the scene is loaded. Shows its first view, or only updates
   * home if the view was moved.
   */
  showFirstViewAgain(): void {
    const subject = this.#subject;
    // A view that the scene defines stays its first view.
    if (!subject || subject.firstView || subject.ownCameras || this.#isViewChosen) return;
    const { controls } = this;
    if (controls.isHome) {
      this.#takeUprightness();
      this.#showHome(this.#firstPose(subject));
      this.#first = this.snapshot();
      return;
    }
    const home = this.#firstPose(subject);
    controls.setPose(controls.pose, home);
    this.#home = { ...(this.#home ?? this.keptView), pose: home };
    this.#first = { ...this.snapshot(), pose: home };
  }

  /**
   * Call it after `follow`, when the scene was framed at the user's wish. Goes to the framing,
   * which becomes home.
   */
  goToFraming(): void {
    const subject = this.#subject;
    if (!subject) return;
    this.endPath();
    this.#isViewChosen = true;
    const home = this.#firstPose(subject);
    this.controls.setPose(this.controls.pose, home);
    this.#home = { ...this.keptView, pose: home };
    this.controls.reset();
  }

  /** Goes to the first view, with its axis up, its projection and its field of view. */
  reset(): void {
    const home = this.#home;
    if (!home) return;
    this.lookAs(home);
    this.controls.glideTo(home.pose);
  }

  /** Aspect ratio and field of view of the image for which first views are computed. */
  get framedShape(): { aspect: number; fovYDegrees: number } {
    const aspect = this.#aspect;
    return { aspect, fovYDegrees: verticalFov(FIRST_LOOK.fovDegrees, aspect) };
  }

  /** The direction that points up in the image, in the unflipped scene. */
  get upInScene(): Vec3 {
    return this.#inScene(this.controls.pose.up);
  }

  /** The current view as an orbit. */
  get keptView(): KeptView {
    const { isFlipped, isZUp, look } = this.#store.getState();
    const { fovDegrees, isOrthographic } = look;
    return { pose: this.controls.pose, fovDegrees, isOrthographic, isFlipped, isZUp };
  }

  snapshot(): CameraSnapshot {
    const { cameraIndex } = this.#store.getState();
    const { keptView } = this;
    return { ...keptView, home: this.#home ?? keptView, cameraIndex };
  }

  /**
   * Restores a view. Invalid views, and views too far away to see the scene, become the first view.
   */
  restore(snapshot: CameraSnapshot): void {
    const fault = this.#faultOf(snapshot);
    if (fault !== null) {
      this.showFirstView();
      this.#store.setState({
        notice: `The view cannot be shown: ${fault} The whole scene is shown instead.`,
      });
      return;
    }
    this.#isViewChosen = true;
    const { pose, home, fovDegrees, isOrthographic, cameraIndex, isFlipped, isZUp } = snapshot;
    this.#store.setState(({ look }) => ({
      look: { ...look, fovDegrees, isOrthographic },
      cameraIndex,
      isFlipped,
      isZUp,
    }));
    this.#home = home;
    this.controls.setPose(pose, this.#homePose());
  }

  /** Advances by `elapsedMs`; returns whether another frame is needed. */
  update(elapsedMs: number): boolean {
    const isMoved = this.#motion?.(elapsedMs) ?? false;
    const isGliding = this.controls.update(elapsedMs);
    return this.#makeRoom(elapsedMs) || isMoved || isGliding;
  }

  /**
   * Sets the area that panels cover. The camera stays; its image shifts, so that the free area
   * shows the image of a window of its size.
   *
   * @param isAtOnce whether the picture's size changes too, so that the shift is not animated.
   */
  setCovered(covered: Covered, isAtOnce: boolean): void {
    if (isSameCovered(covered, this.#covered)) return;
    this.#covered = covered;
    if (isAtOnce) this.#glide.goTo(covered, true);
    this.#onChange();
  }

  #makeRoom(elapsedMs: number): boolean {
    // Own cameras of the scene are exact to the pixel, so they do not shift.
    const isOwn = this.ownCamera !== undefined;
    this.#glide.goTo(isOwn ? NOTHING_COVERED : this.#covered, isOwn || this.isMotionReduced);
    const isGliding = this.#glide.update(elapsedMs);
    this.controls.covered = this.#glide.now;
    this.controls.fovYDegrees = this.#fovYDegreesAt(freeAspect(this.#aspect, this.#glide.now));
    return isGliding;
  }

  /** Position of the target in the image, as fractions from its top left. */
  get middle(): readonly [xPart: number, yPart: number] {
    const { left, right, top, bottom } = this.covered;
    return [(1 + left - right) / 2, (1 + top - bottom) / 2];
  }

  /** The area that panels cover, as far as the picture has made room. */
  get covered(): Covered {
    return this.#glide.now;
  }

  /** Whether the user asks for reduced motion. */
  get isMotionReduced(): boolean {
    return this.#isMotionReduced();
  }

  /** Lets `motion` move the camera from now on; null: only the controls do. */
  setMotion(motion: CameraMotion | null): void {
    this.#motion = motion;
    this.#onChange();
  }

  /** Radius of the subject, world units. */
  get subjectRadius(): number {
    return this.#subject ? placeOf(this.#subject).radius : 1;
  }

  /** The subject as it is drawn, without stray splats; null before there is a scene. */
  get subjectSphere(): Sphere | null {
    return this.#subject && this.#placed(placeOf(this.#subject));
  }

  /** Whether the scene is a thing that cameras stand around; false before there is a scene. */
  get isSubjectObject(): boolean {
    return this.#subject?.framing?.kind === 'object';
  }

  /** Height of the ground along the current up; null if none was found. */
  get groundHeight(): number | null {
    const framing = this.#subject?.framing;
    if (!framing || dot(framing.up, this.upInScene) < SAME_UP_COSINE) return null;
    return framing.groundHeight;
  }

  /** The scene's own camera for the image's aspect ratio, unless the view has been moved. */
  get ownCamera(): Camera | undefined {
    return this.controls.isHome ? this.#ownCameraAt(this.#store.getState().cameraIndex) : undefined;
  }

  /** The camera that shows the controls' pose in the free area. */
  get orbitCamera(): Camera {
    const { now } = this.#glide;
    return besideCovered(this.#orbitCameraAt(freeAspect(this.#aspect, now)), now);
  }

  /** The current camera as if nothing covered the picture. */
  get centredCamera(): Camera {
    return this.ownCamera ?? this.#orbitCameraAt(this.#aspect);
  }

  #orbitCameraAt(aspect: number): Camera {
    return this.cameraOf(this.snapshot(), aspect);
  }

  /** The camera of a view in an image of this aspect ratio, without panels. */
  cameraOf({ pose, fovDegrees, isOrthographic, isFlipped }: ViewedCamera, aspect: number): Camera {
    const subject = this.#subject;
    if (!subject) throw new Error('The camera has no scene to look at.');
    const fovYDegrees = verticalFov(fovDegrees, aspect);
    const extent = placed(subject.extent, isFlipped);
    if (isOrthographic) return orthographicCamera({ ...parallelView(pose, extent, fovYDegrees), aspect });
    // By bounds, not by framing: a link then shows the same, whenever the scene was framed.
    const { near, far } = subject.firstView ?? depthRange(pose, placed(subject.sphere, isFlipped), extent);
    return perspectiveCamera({ ...lookAt(pose), fovYDegrees, aspect, near, far });
  }

  /**
   * The reason why a view cannot be shown; null if it can. URLs and files may contain any numbers.
   */
  #faultOf(view: ViewedCamera): string | null {
    const subject = this.#subject;
    if (!subject) return null;
    const sphere = placed(subject.sphere, view.isFlipped);
    const extent = placed(subject.extent, view.isFlipped);
    const { target, distance } = view.pose;
    const away = Math.hypot(...subtract(target, sphere.center)) + distance;
    const strays = Math.hypot(...subtract(extent.center, sphere.center)) + extent.radius;
    const { radius } = sphere;
    const reach = Math.min(FARTHEST_RADII * radius + strays, FARTHEST_STRAY_RADII * radius);
    if (!(away <= reach)) return 'The camera is too far from the scene.';
    try {
      this.cameraOf(view, this.#aspect);
      return null;
    } catch (error) {
      if (error instanceof InvalidArgumentError) return error.message;
      throw error;
    }
  }

  /** Whether the current view is the computed first view, and the user has chosen no other. */
  get isFoundFirst(): boolean {
    const { framing, firstView, ownCameras } = this.#subject ?? {};
    return !!framing && !firstView && !ownCameras && !this.#isViewChosen && this.controls.isHome;
  }

  /** Names of the scene's own cameras. */
  get ownCameraNames(): readonly string[] {
    return Object.keys(this.#ownCameras());
  }

  /** Turns the scene upside down; the view keeps facing the same side. */
  toggleFlip(): void {
    this.setUpAxis(oppositeAxis(upAxisOf(this.#store.getState())));
  }

  /** Shows one of the scene's axes upwards; the viewpoint turns with it. */
  setUpAxis(axis: UpAxis): void {
    const state = this.#store.getState();
    if (!state.scene?.canFlip) return;
    this.#isViewChosen = true;
    const from = upAxisOf(state);
    if (from === axis) return;
    const { controls } = this;
    const { pose, isHome } = controls;
    const { poses } = this.#turned.shown === pose ? this.#turned : { poses: new Map<UpAxis, OrbitPose>() };
    poses.set(from, pose);
    this.#store.setState(uprightnessOf(axis));
    const home = this.#homePose();
    const shown = isHome ? home : (poses.get(axis) ?? this.#levelled(turnedPose(pose, from, axis)));
    this.#turned = { shown, poses };
    controls.setPose(shown, home);
  }

  /** The pose of home with the present axis up. */
  #homePose(): OrbitPose {
    const { pose, ...uprightness } = this.#home ?? this.keptView;
    return turnedPose(pose, upAxisOf(uprightness), upAxisOf(this.#store.getState()));
  }

  /** A scene that stands at an angle to its axis does so in all views with that axis up. */
  #levelled(pose: OrbitPose): OrbitPose {
    const isOfHome = this.#home && upAxisOf(this.#home) === upAxisOf(this.#store.getState());
    return isOfHome && this.#home ? { ...pose, up: this.#home.pose.up } : pose;
  }

  /** Ends a playing path and goes to a view, if it can be shown. */
  goTo(view: KeptView): void {
    const fault = this.#faultOf(view);
    if (fault !== null) {
      this.#store.setState({ notice: `The view cannot be shown: ${fault}` });
      return;
    }
    this.endPath();
    this.lookAs(view);
    this.controls.glideTo(view.pose);
  }

  /** Uses the settings of `view` from the current position. */
  lookAs(view: KeptView): void {
    const { fovDegrees, isOrthographic } = view;
    if (upAxisOf(view) !== upAxisOf(this.#store.getState())) this.setUpAxis(upAxisOf(view));
    this.setLook({ fovDegrees, isOrthographic });
  }

  /** Ends a playing path; the camera stays where it is. */
  endPath(): void {
    if (!this.#store.getState().isPathPlaying) return;
    this.#store.setState({ isPathPlaying: false });
    this.setMotion(null);
  }

  /** Changes the look from the current position. */
  setLook(change: Partial<Look>): void {
    this.#store.setState(({ look }) => ({ look: { ...look, ...change } }));
    this.#onChange();
  }

  /**
   * Moves the camera, without turning it, to the distance of the scene's framing. A place, such as
   * a room, is framed from inside. If the scene has changed since it was framed, all of it is
   * shown.
   */
  frameScene(): void {
    const { controls } = this;
    const subject = this.#subject;
    if (!subject) return;
    const { framing, detail, sphere } = subject;
    if (!framing || !detail) {
      controls.glideTo(framedPose(controls.pose, this.#placed(sphere), this.#fovYDegrees, this.#aspect));
      return;
    }
    const { fovDegrees } = this.#store.getState().look;
    // As large in the image as with the field of view of the framing.
    const part = fitDistance(1, fovDegrees, 1) / fitDistance(1, FIRST_LOOK.fovDegrees, 1);
    const distance = part * Math.hypot(...subtract(framing.position, framing.target));
    controls.glideTo({ ...controls.pose, target: this.#inScene(framing.target), distance });
  }

  /** Centres `point`, of the scene as drawn, in the free area and makes it the orbit's target. */
  focus(point: Vec3): void {
    const { controls } = this;
    const { pose, distanceRange } = controls;
    // A parallel projection has no depth to keep.
    const { isOrthographic } = this.#store.getState().look;
    controls.glideTo(isOrthographic ? { ...pose, target: point } : focused(pose, point, distanceRange));
  }

  /** Shows the scene's next own camera; −1: the previous one. */
  step(by: 1 | -1): void {
    const { scene, cameraIndex } = this.#store.getState();
    const count = scene?.cameras.length ?? 0;
    if (count > 0) this.#showOwnCamera((cameraIndex + by + count) % count);
  }

  /** Moves the view by a pressed key; returns whether the key has a function here. */
  handleKey(event: KeyboardEvent): boolean {
    if (event.key !== '[' && event.key !== ']') return this.controls.handleKey(event);
    this.step(event.key === ']' ? 1 : -1);
    return true;
  }

  /** Shows one of the scene's own cameras; moving continues with an orbit close to it. */
  #showOwnCamera(index: number): void {
    const subject = this.#subject;
    const camera = this.#ownCameraAt(index);
    const ownCameras = subject?.ownCameras;
    if (!ownCameras || !camera) return;
    const { pose, fovDegrees } = ownCameras.orbitNear(camera, subject.sphere, this.#aspect);
    this.setLook({ fovDegrees });
    this.#store.setState({ cameraIndex: index });
    this.#showHome(pose);
  }

  #ownCameras(): Readonly<Record<string, Camera>> {
    return this.#subject?.ownCameras?.at(this.#aspect) ?? {};
  }

  #ownCameraAt(index: number): Camera | undefined {
    return Object.values(this.#ownCameras())[index];
  }

  /**
   * Field of view without panels. A pose that shows a whole sphere then does so in any free area.
   */
  get #fovYDegrees(): number {
    return this.#fovYDegreesAt(this.#aspect);
  }

  #fovYDegreesAt(aspect: number): number {
    return verticalFov(this.#store.getState().look.fovDegrees, aspect);
  }

  /** Shows the scene in its default orientation, if known. */
  #takeUprightness(): void {
    this.#store.setState(({ firstUp }) => uprightnessOf(firstUp));
  }

  #firstPose({ framing, sphere }: CameraSubject): OrbitPose {
    if (framing) {
      const [position, target, up] = [framing.position, framing.target, framing.up].map((each) =>
        this.#inScene(each),
      );
      return poseFromLookAt({ position, target, up });
    }
    const up = upVector(this.#store.getState());
    return firstPose(this.#placed(sphere), this.#fovYDegrees, this.#aspect, up);
  }

  /** Converts between the unflipped and the drawn scene. A half turn is its own inverse. */
  #inScene(point: Vec3): Vec3 {
    return this.#store.getState().isFlipped ? flippedPoint(point) : point;
  }

  get #aspect(): number {
    const { widthPx, heightPx } = this.#store.getState();
    return widthPx > 0 ? widthPx / heightPx : 1;
  }

  /** Converts `sphere` to the scene as drawn, flipped or not. */
  #placed(sphere: Sphere): Sphere {
    return placed(sphere, this.#store.getState().isFlipped);
  }
}

/** Far from the origin, few digits are left for the distance between camera and target. */
function withLeastRadius(sphere: Sphere): Sphere {
  return { ...sphere, radius: Math.max(sphere.radius, LEAST_RADIUS_PART * Math.hypot(...sphere.center)) };
}

function placeOf({ detail, sphere }: CameraSubject): Sphere {
  return detail ?? sphere;
}

function firstUpOf({ framing, firstView, isUpsideDown }: CameraSubject): UpAxis {
  if (framing && !firstView) return nearestUpAxis(framing.up);
  return isUpsideDown ? '-y' : 'y';
}

function placed(sphere: Sphere, isFlipped: boolean): Sphere {
  return isFlipped ? { ...sphere, center: flippedPoint(sphere.center) } : sphere;
}
