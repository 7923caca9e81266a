Require Import Reals ZArith Lra.
Require Import Gappa.Gappa_library.
From Flocq Require Import Core.
From Gappa Require Gappa_round_def Gappa_round Gappa_fixed.

(* Rounding half up, as the code does it. The library has what proofs about it need, but not the name
   that Gappa gives it, nor its two theorems: Gappa writes UNKNOWN_ before theirs, and no arguments. *)
Definition rndNU (x : R) : Z := Zfloor (x + / 2).

Lemma rndNU_is_nearest : forall x : R, Znearest (fun _ => true) x = rndNU x.
Proof.
  intro x. unfold rndNU, Znearest.
  assert (H1 := Zfloor_lb x). assert (H2 := Zfloor_ub x).
  destruct (Rcompare_spec (x - IZR (Zfloor x)) (/ 2)) as [H | H | H].
  - symmetry. apply Zfloor_imp. rewrite plus_IZR. simpl. split; lra.
  - symmetry. rewrite Zceil_floor_neq by lra. apply Zfloor_imp. rewrite ! plus_IZR. simpl. split; lra.
  - symmetry. rewrite Zceil_floor_neq by lra. apply Zfloor_imp. rewrite ! plus_IZR. simpl. split; lra.
Qed.

Lemma roundNU_eq : forall x : R, Gappa_round.rndG Gappa_round_def.roundNU x = rndNU x.
Proof.
  intro x. rewrite <- rndNU_is_nearest.
  apply Gappa_round.roundN_eq; intros m Hm b c; destruct b, c; reflexivity.
Qed.

Canonical Structure roundNU_cs :=
  Gappa_round.Build_rndG_prop Gappa_round_def.roundNU rndNU roundNU_eq.

Lemma fixed_error_nu : forall (e : Z) (x : R) (zi : FF),
  Gappa_fixed.fixed_error_n_helper e zi = true -> BND (round radix2 (FIX_exp e) rndNU x - x) zi.
Proof.
  intros e x zi H.
  rewrite <- (round_ext radix2 (FIX_exp e) (Znearest (fun _ => true)) rndNU rndNU_is_nearest).
  exact (Gappa_fixed.fixed_error_n _ e x zi H).
Qed.

Notation UNKNOWN_fixed_round_nu :=
  (Gappa_fixed.fixed_round roundNU_cs _ _ _ _ ltac:(eassumption) _) (only parsing).
Notation UNKNOWN_fixed_error_nu := (fixed_error_nu _ _ _ _) (only parsing).
