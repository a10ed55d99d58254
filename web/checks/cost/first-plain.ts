/** A page that loads a .glb with plain three.js and says when its first picture was there. */
import { AmbientLight, Color, Scene, WebGLRenderer } from "three";
import { GLTFLoader } from "three/addons/loaders/GLTFLoader.js";
import { firstPicture, newCamera } from "./first-picture.js";

const gltf = await new GLTFLoader().loadAsync("/scene.glb");
const renderer = new WebGLRenderer({ preserveDrawingBuffer: true });
const scene = new Scene().add(gltf.scene, new AmbientLight(new Color(1, 1, 1), 1));
firstPicture(renderer, () => renderer.render(scene, newCamera()));
