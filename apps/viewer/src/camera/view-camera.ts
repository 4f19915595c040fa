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
import { nearestUpAxis, type UpAxis, upAxisOf, uprightnessOf, upVector } from '../state/up-axis.ts';
import { dot, subtract, type Vec3 } from '../state/vec3.ts';
import { besideCovered, type Covered, CoveredGlide, freeAspect, NOTHING_COVERED } from './covered.ts';
import { flippedPoint, flippedPose } from './flip.ts';
import { depthRange, firstPose, fitDistance, framedPose, parallelView } from './framing.ts';
import type { GamepadSticks } from './gamepad-motion.ts';
import { OrbitControls, type OrbitControlsOptions } from './orbit-controls.ts';
import type { orbitNear } from './orbit-near.ts';
import type { Sphere } from './scene-bounds.ts';

/** Cameras that a scene comes with, and what moving on from them takes: few scenes need it. */
export interface OwnCameras {
  readonly at: (aspect: number) => Readonly<Record<string, Camera>>;
  readonly orbitNear: typeof orbitNear;
}

/** The parts of a scene that its camera needs. */
export interface CameraSubject {
  /** Bounds of the scene without stray splats; unflipped. */
  readonly sphere: Sphere;
  /** Bounds of all splats, unflipped. */
  readonly extent: Sphere;
  /** How to show it first where it comes with no view; null: by `sphere`. Unflipped. */
  readonly framing: SceneFraming | null;
  /** Place of most of its detail, unflipped; null where it was not framed as it is now. */
  readonly detail: Sphere | null;
  /** The view that it comes with. */
  readonly firstView:
    | (LookAt & { readonly fovYDegrees: number; readonly near: number; readonly far: number })
    | null;
  /**
   * Cameras whose exact images the scene is about, by name, for an image of this aspect ratio.
   * Orbiting need not be able to reach them: they may be orthographic, off-centre or mirrored.
   */
  readonly ownCameras: OwnCameras | null;
  /** In files of its format y mostly points down, as computer vision has it. */
  readonly isUpsideDown: boolean;
}

/** Moves the camera: called before each frame; returns whether another frame is needed. */
export type CameraMotion = (elapsedMs: number) => boolean;

/** A scene is smaller than a pixel from so many of its radii away. */
const FARTHEST_RADII = 1e4;
/** Stray splats may be farther, but not where numbers have no digits left for moves at the scene. */
const FARTHEST_STRAY_RADII = 1e9;

/** Of a scene's distance from 0: the least radius that it is framed with, a centimetre at 10,000 km. */
const LEAST_RADIUS_PART = 1e-9;

/** Directions that are closer to each other are one way up: about 8°. */
const SAME_UP_COSINE = 0.99;

/** The camera of the shown scene: an orbit, or a camera of the scene until the view is moved. */
export class ViewCamera {
  readonly controls: OrbitControls;
  /** What gamepads do instead of orbiting. */
  steering: ((sticks: GamepadSticks, elapsedS: number) => void) | null = null;
  readonly #store: ViewerStore;
  readonly #onChange: () => void;
  readonly #isMotionReduced: () => boolean;
  readonly #glide = new CoveredGlide();
  #covered = NOTHING_COVERED;
  #subject: CameraSubject | null = null;
  #first: CameraSnapshot | null = null;
  #motion: CameraMotion | null = null;
  /** Whether somebody has said which way is up, or from where to look: the first view is not shown again. */
  #isViewChosen = false;

  constructor(store: ViewerStore, options: OrbitControlsOptions) {
    this.#store = store;
    this.#onChange = options.onChange;
    this.#isMotionReduced = options.isMotionReduced ?? (() => false);
    this.controls = new OrbitControls(options);
  }

  /** Looks at `subject` from now on; the pose stays until `showFirstView` or `restore`. */
  follow(subject: CameraSubject): void {
    const sphere = withLeastRadius(subject.sphere);
    const detail = subject.detail && withLeastRadius(subject.detail);
    this.#subject = { ...subject, sphere, detail };
    this.controls.distanceRange = { min: this.subjectRadius * 1e-3, max: sphere.radius * 100 };
    this.#store.setState({ firstUp: firstUpOf(subject) });
  }

  /** First view of the scene; null before there is one, and after `forgetFirst`. */
  get first(): CameraSnapshot | null {
    return this.#first;
  }

  /** After `follow`, of a scene whose files have moved: reopened, it has another first view. */
  forgetFirst(): void {
    this.#first = null;
  }

  showFirstView(): void {
    const subject = this.#subject;
    if (!subject) return;
    this.#placeFirst(subject);
    this.#first = this.snapshot();
  }

  /** Shows the scene as `camera` did elsewhere; home is its first view nevertheless. */
  showLinked(camera: LinkedCamera): void {
    this.showFirstView();
    const subject = this.#subject;
    if (!subject) return;
    // Own cameras show the scene as it is.
    if (subject.ownCameras) this.#showOwnCamera(camera.cameraIndex);
    else if (upAxisOf(camera) !== upAxisOf(this.#store.getState())) this.setUpAxis(upAxisOf(camera));
    const { cameraIndex, isFlipped, isZUp, home } = this.snapshot();
    this.restore({ ...camera, cameraIndex, isFlipped, isZUp, home });
    // Home becomes better known, as the scene does, while the view stays.
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
    this.controls.setPose(firstView ? poseFromLookAt(firstView) : this.#firstPose(subject));
  }

  /** After `follow`, of a scene better known now: shows its first view, or lets Home do so if the view was moved. */
  showFirstViewAgain(): void {
    const subject = this.#subject;
    // One that the scene came with is the first view still.
    if (!subject || subject.firstView || subject.ownCameras || this.#isViewChosen) return;
    const { controls } = this;
    if (controls.isHome) {
      this.#takeUprightness();
      controls.setPose(this.#firstPose(subject));
      this.#first = this.snapshot();
      return;
    }
    const home = this.#firstPose(subject);
    controls.setPose(controls.pose, home);
    this.#first = { ...this.snapshot(), pose: home };
  }

  /** After `follow`, of a scene framed as a person wished: goes there, which is home from now on. */
  goToFraming(): void {
    const subject = this.#subject;
    if (!subject) return;
    this.endPath();
    this.#isViewChosen = true;
    const { controls } = this;
    controls.setPose(controls.pose, this.#firstPose(subject));
    controls.reset();
  }

  /** The image that first views are found for: its shape, and the field of view that scenes begin with. */
  get framedShape(): { aspect: number; fovYDegrees: number } {
    const aspect = this.#aspect;
    return { aspect, fovYDegrees: verticalFov(FIRST_LOOK.fovDegrees, aspect) };
  }

  /** The direction that points up in the image, in the scene as it is: unflipped. */
  get upInScene(): Vec3 {
    return this.#inScene(this.controls.pose.up);
  }

  /** The view on the screen, as an orbit. */
  get keptView(): KeptView {
    const { isFlipped, isZUp, look } = this.#store.getState();
    const { fovDegrees, isOrthographic } = look;
    return { pose: this.controls.pose, fovDegrees, isOrthographic, isFlipped, isZUp };
  }

  snapshot(): CameraSnapshot {
    const { cameraIndex } = this.#store.getState();
    return { ...this.keptView, home: this.controls.home, cameraIndex };
  }

  /** Shows a view as it was; one that no camera can have, or so far away that nothing is seen, as the first. */
  restore(snapshot: CameraSnapshot): void {
    const fault = this.#faultOf(snapshot);
    if (fault !== null) {
      this.showFirstView();
      this.#store.setState({ notice: `The view cannot be shown: ${fault} This is the whole scene.` });
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
    this.controls.setPose(pose, home);
  }

  /** Glides `elapsedMs` further; returns whether another frame is needed to arrive. */
  update(elapsedMs: number): boolean {
    const isMoved = this.#motion?.(elapsedMs) ?? false;
    const isGliding = this.controls.update(elapsedMs);
    return this.#makeRoom(elapsedMs) || isMoved || isGliding;
  }

  /**
   * A panel covers something else from now on. The camera stays as it is: its image moves over, and
   * shows in the free area what it would show in a window of that size.
   *
   * @param isAtOnce whether the picture has another size too.
   */
  setCovered(covered: Covered, isAtOnce: boolean): void {
    const { right, bottom } = this.#covered;
    if (covered.right === right && covered.bottom === bottom) return;
    this.#covered = covered;
    if (isAtOnce) this.#glide.goTo(covered, true);
    this.#onChange();
  }

  #makeRoom(elapsedMs: number): boolean {
    // The images of the scene's own cameras are about each pixel.
    const isOwn = this.ownCamera !== undefined;
    this.#glide.goTo(isOwn ? NOTHING_COVERED : this.#covered, isOwn || this.isMotionReduced);
    const isGliding = this.#glide.update(elapsedMs);
    this.controls.covered = this.#glide.now;
    this.controls.fovYDegrees = this.#fovYDegreesAt(freeAspect(this.#aspect, this.#glide.now));
    return isGliding;
  }

  /** Place of the target in the image, in parts of its sides from its top left. */
  get middle(): readonly [xPart: number, yPart: number] {
    const { right, bottom } = this.#glide.now;
    return [(1 - right) / 2, (1 - bottom) / 2];
  }

  /** Whether the person wants no movement that is not theirs. */
  get isMotionReduced(): boolean {
    return this.#isMotionReduced();
  }

  /** Something moves the camera from now on, or with null nothing but the controls. */
  setMotion(motion: CameraMotion | null): void {
    this.#motion = motion;
    this.#onChange();
  }

  /** Radius of the subject, world units. */
  get subjectRadius(): number {
    return this.#subject ? placeOf(this.#subject).radius : 1;
  }

  /** Place of the subject as it is drawn, without stray splats; null before there is a scene. */
  get subjectSphere(): Sphere | null {
    return this.#subject && this.#placed(placeOf(this.#subject));
  }

  /** Height of the ground along the up of the shown pose; null where none was found. */
  get groundHeight(): number | null {
    const framing = this.#subject?.framing;
    if (!framing || dot(framing.up, this.upInScene) < SAME_UP_COSINE) return null;
    return framing.groundHeight;
  }

  /** The scene's own camera for this shape of the image, unless the view has been moved. */
  get ownCamera(): Camera | undefined {
    return this.controls.isHome ? this.#ownCameraAt(this.#store.getState().cameraIndex) : undefined;
  }

  /** The camera that shows the pose of the controls in the free area. */
  get orbitCamera(): Camera {
    const { now } = this.#glide;
    return besideCovered(this.#orbitCameraAt(freeAspect(this.#aspect, now)), now);
  }

  /** The camera that is shown, as it is where nothing covers the picture. */
  get centredCamera(): Camera {
    return this.ownCamera ?? this.#orbitCameraAt(this.#aspect);
  }

  #orbitCameraAt(aspect: number): Camera {
    return this.cameraOf(this.snapshot(), aspect);
  }

  /** The camera that shows a view of the scene in an image of this shape, without a panel. */
  cameraOf({ pose, fovDegrees, isOrthographic, isFlipped }: ViewedCamera, aspect: number): Camera {
    const subject = this.#subject;
    if (!subject) throw new Error('The camera has no scene to look at.');
    const fovYDegrees = verticalFov(fovDegrees, aspect);
    const extent = placed(subject.extent, isFlipped);
    if (isOrthographic) return orthographicCamera({ ...parallelView(pose, extent, fovYDegrees), aspect });
    // By bounds: a link shows the same, whenever the scene was framed.
    const { near, far } = subject.firstView ?? depthRange(pose, placed(subject.sphere, isFlipped), extent);
    return perspectiveCamera({ ...lookAt(pose), fovYDegrees, aspect, near, far });
  }

  /** Why a view cannot be shown, in a sentence; null if it can. Addresses and files may have any numbers. */
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
    if (!(away <= reach)) return 'It is too far from the scene.';
    try {
      this.cameraOf(view, this.#aspect);
      return null;
    } catch (error) {
      if (error instanceof InvalidArgumentError) return error.message;
      throw error;
    }
  }

  /** Whether the view is the first one that was found for the scene, and nobody has asked for another. */
  get isFoundFirst(): boolean {
    const { framing, firstView, ownCameras } = this.#subject ?? {};
    return !!framing && !firstView && !ownCameras && !this.#isViewChosen && this.controls.isHome;
  }

  /** Names of the scene's own cameras. */
  get ownCameraNames(): readonly string[] {
    return Object.keys(this.#ownCameras());
  }

  /** Turns the scene the other way up; the view keeps facing the same side of it. */
  toggleFlip(): void {
    if (!this.#store.getState().scene?.canFlip) return;
    this.#isViewChosen = true;
    this.#store.setState(({ isFlipped }) => ({ isFlipped: !isFlipped }));
    this.controls.setPose(flippedPose(this.controls.pose), flippedPose(this.controls.home));
  }

  /** Shows an axis of the scene's own upwards; the point of view turns with it. */
  setUpAxis(axis: UpAxis): void {
    const { scene, isFlipped } = this.#store.getState();
    if (!scene?.canFlip) return;
    const uprightness = uprightnessOf(axis);
    if (uprightness.isFlipped !== isFlipped) this.toggleFlip();
    this.#isViewChosen = true;
    this.#store.setState({ isZUp: uprightness.isZUp });
    const up = upVector(uprightness);
    const { pose, home } = this.controls;
    this.controls.setPose({ ...pose, up }, { ...home, up });
  }

  /** Ends a path that is played, and goes to a view, if that can be shown. */
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

  /** Looks as in `view`, but from where the camera is. */
  lookAs(view: KeptView): void {
    const { fovDegrees, isOrthographic } = view;
    if (upAxisOf(view) !== upAxisOf(this.#store.getState())) this.setUpAxis(upAxisOf(view));
    this.setLook({ fovDegrees, isOrthographic });
  }

  /** The camera stays where it is on a path that is played. */
  endPath(): void {
    if (!this.#store.getState().isPathPlaying) return;
    this.#store.setState({ isPathPlaying: false });
    this.setMotion(null);
  }

  /** Looks in another way from where the camera is. */
  setLook(change: Partial<Look>): void {
    this.#store.setState(({ look }) => ({ look: { ...look, ...change } }));
    this.#onChange();
  }

  /**
   * Moves the camera, without turning it, to see the scene from as far away as its framing does; of a
   * place, that is within it. One that was not framed as it is now is seen whole.
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
    // As large in the image as with the field of view that it was framed for.
    const part = fitDistance(1, fovDegrees, 1) / fitDistance(1, FIRST_LOOK.fovDegrees, 1);
    const distance = part * Math.hypot(...subtract(framing.position, framing.target));
    controls.glideTo({ ...controls.pose, target: this.#inScene(framing.target), distance });
  }

  /** Brings `point`, of the scene as drawn, to the middle of the free area; turns around it. */
  focus(point: Vec3): void {
    const { controls } = this;
    const { pose, distanceRange } = controls;
    // A parallel projection has no depth to keep.
    const { isOrthographic } = this.#store.getState().look;
    controls.glideTo(isOrthographic ? { ...pose, target: point } : focused(pose, point, distanceRange));
  }

  /** Shows the scene's next own camera, or with −1 the one before. */
  step(by: 1 | -1): void {
    const { scene, cameraIndex } = this.#store.getState();
    const count = scene?.cameras.length ?? 0;
    if (count > 0) this.#showOwnCamera((cameraIndex + by + count) % count);
  }

  /** Moves the view by the key that was pressed; returns whether the key means anything here. */
  handleKey(event: KeyboardEvent): boolean {
    if (event.key !== '[' && event.key !== ']') return this.controls.handleKey(event);
    this.step(event.key === ']' ? 1 : -1);
    return true;
  }

  /** Shows an own camera of the scene; moving goes on as an orbit from about there. */
  #showOwnCamera(index: number): void {
    const subject = this.#subject;
    const camera = this.#ownCameraAt(index);
    const ownCameras = subject?.ownCameras;
    if (!ownCameras || !camera) return;
    const { pose, fovDegrees } = ownCameras.orbitNear(camera, subject.sphere, this.#aspect);
    this.setLook({ fovDegrees });
    this.#store.setState({ cameraIndex: index });
    this.controls.setPose(pose);
  }

  #ownCameras(): Readonly<Record<string, Camera>> {
    return this.#subject?.ownCameras?.at(this.#aspect) ?? {};
  }

  #ownCameraAt(index: number): Camera | undefined {
    return Object.values(this.#ownCameras())[index];
  }

  /** With no panel open. Poses that show all of a sphere then do so in any free area. */
  get #fovYDegrees(): number {
    return this.#fovYDegreesAt(this.#aspect);
  }

  #fovYDegreesAt(aspect: number): number {
    return verticalFov(this.#store.getState().look.fovDegrees, aspect);
  }

  /** Shows the scene the way up that it comes with, as far as that is known. */
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

  /** Between the scene as it is and as it is drawn: flipped or not. Half a turn undoes itself. */
  #inScene(point: Vec3): Vec3 {
    return this.#store.getState().isFlipped ? flippedPoint(point) : point;
  }

  get #aspect(): number {
    const { widthPx, heightPx } = this.#store.getState();
    return widthPx > 0 ? widthPx / heightPx : 1;
  }

  /** `sphere` in the scene as it is drawn: flipped or not. */
  #placed(sphere: Sphere): Sphere {
    return placed(sphere, this.#store.getState().isFlipped);
  }
}

/** Of places that are far from 0 few digits are left for a camera to be away from its target. */
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
