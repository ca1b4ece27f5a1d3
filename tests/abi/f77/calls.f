C     Every subroutine of the face with status 0, its result compared.
      PROGRAM CALLS
      INTEGER IP, IERR
      CALL SMALL(IP)
      CALL OPTS(IP)
      CALL SOLVES(IP, 10D0, -0.3D0, 'the problem by hand')
      CALL ANSWER(IP)
      CALL INSIDE(IP)
      CALL CHANGE(IP)
      CALL VALUES(IP)
      CALL NUMBER(IP)
      CALL STATES(IP)
      CALL FINDS(IP)
      CALL FTFREE(IP, IERR)
      CALL OK(IERR, 'FTFREE')
      CALL HOLDS(IP .EQ. 0, 'FTFREE leaves IP')
      CALL TABLE
      CALL PLACES
      CALL KEPT
      CALL ELEMS
      CALL RUBS
      CALL STRIPS
      END

C     Options, names, version.
      SUBROUTINE OPTS(IP)
      INCLUDE 'feti_contact_f77.inc'
      INTEGER IP, IERR, K, N, I, L, ITYP
      DOUBLE PRECISION D, DMIN, DMAX, DDEF
      CHARACTER NAME*40, DOC*300, TEXT*40
      CALL FTSETD(IP, 'tolerance', 1D-11, IERR)
      CALL OK(IERR, 'FTSETD')
      CALL FTGETD(IP, 'tolerance', D, IERR)
      CALL OK(IERR, 'FTGETD')
      CALL SAME(D * 1D11, 1D0, 'tolerance')
      CALL FTSETI(IP, 'threads', 1, IERR)
      CALL OK(IERR, 'FTSETI')
      CALL FTGETI(IP, 'threads', I, IERR)
      CALL OK(IERR, 'FTGETI')
      CALL HOLDS(I .EQ. 1, 'threads')
      CALL FTSETC(IP, 'start', 'previous', IERR)
      CALL OK(IERR, 'FTSETC')
      CALL FTGETC(IP, 'start', TEXT, L, IERR)
      CALL OK(IERR, 'FTGETC')
      CALL HOLDS(TEXT .EQ. 'previous' .AND. L .EQ. 8, 'start')
      CALL FTGETC(IP, 'start', TEXT(1:4), L, IERR)
      CALL OK(IERR, 'FTGETC')
      CALL HOLDS(TEXT(1:4) .EQ. 'prev' .AND. L .EQ. 8, 'start, cut')
      CALL FTSETC(IP, 'start', 'cold', IERR)
      CALL OK(IERR, 'FTSETC')
      CALL FTOPTN(N)
      L = 0
      DO 10 K = 1, N
        CALL FTOPTA(K, NAME, DOC, ITYP, DMIN, DMAX, DDEF, I, TEXT, IERR)
        CALL OK(IERR, 'FTOPTA')
        CALL HOLDS(DOC .NE. ' ', 'an option without a sentence')
        IF (NAME .EQ. 'tolerance' .AND. ITYP .EQ. FTODBL) THEN
          IF (DMIN .LE. DDEF .AND. DDEF .LE. DMAX) L = L + 1
        END IF
        IF (NAME .EQ. 'threads' .AND. ITYP .EQ. FTOINT .AND. I .EQ. 0)
     &    L = L + 10
        IF (NAME .EQ. 'start' .AND. ITYP .EQ. FTOCHR .AND. TEXT .EQ.
     &    'cold') L = L + 100
   10 CONTINUE
      CALL HOLDS(L .EQ. 111, 'options are not all described')
      CALL FTSNAM(FTELNH, NAME)
      CALL HOLDS(NAME .EQ. 'FETI_LOAD_NOT_HELD', 'FTSNAM')
      CALL FTSTXT(FTELNH, DOC)
      CALL HOLDS(INDEX(DOC, 'balance') .GT. 0, 'FTSTXT')
      CALL FTSTXT(FTEFIT, DOC)
      CALL HOLDS(INDEX(DOC, 'INTEGER') .GT. 0, 'FTSTXT of the face')
      CALL FTVERS(TEXT, N)
      CALL HOLDS(INDEX(TEXT, '.') .GT. 1 .AND. N .GT. 0, 'FTVERS')
      END

C     The answer by hand.
      SUBROUTINE ANSWER(IP)
      INCLUDE 'feti_contact_f77.inc'
      INTEGER IP, IERR, NB, N, M, ME, IS(2), ICERT(FTNIVE), INFO(3)
      DOUBLE PRECISION U(5), R(2), RLAM(2), RMU(1), GAP(2)
      DOUBLE PRECISION RCERT(FTNRVE), RINFO(1)
      CALL FTCNTS(IP, NB, N, M, ME, IERR)
      CALL OK(IERR, 'FTCNTS')
      CALL HOLDS(NB .EQ. 3 .AND. N .EQ. 5 .AND. M .EQ. 2 .AND. ME .EQ.
     &  1, 'FTCNTS')
      CALL FTDISP(IP, 1, 2, U(1), IERR)
      CALL OK(IERR, 'FTDISP')
      CALL FTDISP(IP, 2, 2, U(3), IERR)
      CALL OK(IERR, 'FTDISP')
      CALL FTDISP(IP, 3, 1, U(5), IERR)
      CALL OK(IERR, 'FTDISP')
      CALL SAME(U(2), -0.2D0, 'u12')
      CALL SAME(U(4), -0.5D0, 'u22')
      CALL SAME(U(5), 0.25D0, 'u31')
      CALL FTREAC(IP, 0, 2, 2, R, IERR)
      CALL OK(IERR, 'FTREAC')
      CALL SAME(R(1), 10D0, 'reaction on the bar')
      CALL FTREAC(IP, FTKEQU, 3, 1, R, IERR)
      CALL OK(IERR, 'FTREAC')
      CALL SAME(R(1), 1D0, 'reaction on the point')
      CALL FTMULT(IP, FTKINE, 2, RLAM, IERR)
      CALL OK(IERR, 'FTMULT')
      CALL FTMULT(IP, FTKEQU, 1, RMU, IERR)
      CALL OK(IERR, 'FTMULT')
      CALL SAME(RMU(1), -1D0, 'mu')
      CALL FTGAPS(IP, 2, GAP, IERR)
      CALL OK(IERR, 'FTGAPS')
      CALL SAME(GAP(1), 0D0, 'closed gap')
      CALL SAME(GAP(2), 0.75D0, 'open gap')
      CALL FTACTV(IP, 2, IS, IERR)
      CALL OK(IERR, 'FTACTV')
      CALL HOLDS(IS(1) .EQ. FTCLOS .AND. IS(2) .EQ. FTOPEN, 'FTACTV')
      CALL FTCHK(IP, 5, U, 2, RLAM, 1, RMU, FTNIVE, ICERT, FTNRVE,
     &  RCERT, IERR)
      CALL OK(IERR, 'FTCHK')
      CALL HOLDS(ICERT(FTVPAS) .EQ. 1 .AND. RCERT(FTRWOR) .LE. 1D0,
     &  'FTCHK refuses the answer')
      U(3) = U(3) - 0.1D0
      CALL FTCHK(IP, 5, U, 2, RLAM, 1, RMU, FTNIVE, ICERT, FTNRVE,
     &  RCERT, IERR)
      CALL OK(IERR, 'FTCHK')
      CALL HOLDS(ICERT(FTVPAS) .EQ. 0 .AND. ICERT(FTVPEN) .EQ. 1 .AND.
     &  RCERT(FTRPEN) .GT. RCERT(FTRLIM), 'FTCHK accepts an overlap')
C     Of the arrays of counts no more is written than there is room for.
      INFO(3) = 77
      RINFO(1) = 77D0
      CALL FTSOLV(IP, 2, INFO, 0, RINFO, IERR)
      CALL OK(IERR, 'FTSOLV')
      CALL HOLDS(INFO(2) .EQ. 3 .AND. INFO(3) .EQ. 77, 'FTSOLV, INFO')
      CALL SAME(RINFO(1), 77D0, 'FTSOLV, RINFO')
      END

C     Null space, generalised inverse, dual operator, phases: the answer
C     of the bar is K+ (f + r) + R alpha, F and d by hand.
      SUBROUTINE INSIDE(IP)
      INCLUDE 'feti_contact_f77.inc'
      INTEGER IP, IERR, NR, IDOF(1), N
      DOUBLE PRECISION R(2), ALPHA(1), X(2), Y(2), V(3), W(3), SECS, B
      CHARACTER NAME*40
      IDOF(1) = 2
      CALL FTBFXS(IP, 2, 1, IDOF, IERR)
      CALL OK(IERR, 'FTBFXS')
      CALL FTSTUP(IP, IERR)
      CALL OK(IERR, 'FTSTUP')
      IDOF(1) = 0
      CALL FTBFIX(IP, 2, 1, IDOF, IERR)
      CALL OK(IERR, 'FTBFIX')
      CALL HOLDS(IDOF(1) .EQ. 2, 'FTBFXS did not hold unknown 2')
      CALL SOLVES(IP, 10D0, -0.3D0, 'other fixing unknowns')
      NR = 0
      CALL FTBNUG(IP, 2, 2, NR, R, 2, IERR)
      CALL OK(IERR, 'FTBNUG')
      CALL HOLDS(NR .EQ. 1, 'dimension of the null space')
      CALL FTBNUG(IP, 2, 2, NR, R, 2, IERR)
      CALL OK(IERR, 'FTBNUG')
      CALL SAME(R(1) / R(2), 1D0, 'null space')
      CALL FTAMPL(IP, 2, 1, ALPHA, IERR)
      CALL OK(IERR, 'FTAMPL')
      X(1) = 10D0
      X(2) = -10D0
      CALL FTBKPL(IP, 2, 2, 1, X, 2, Y, 2, IERR)
      CALL OK(IERR, 'FTBKPL')
      CALL SAME(Y(1) + R(1) * ALPHA(1), -0.3D0, 'K+ (f + r) + R alpha')
      CALL SAME(Y(2) + R(2) * ALPHA(1), -0.5D0, 'K+ (f + r) + R alpha')
      V(1) = 0D0
      V(2) = 2D0
      V(3) = 0D0
      CALL FTDAPP(IP, 3, V, W, IERR)
      CALL OK(IERR, 'FTDAPP')
      CALL SAME(W(2) + W(3), 1D0, 'F times the second row')
      CALL FTDRHS(IP, 3, W, IERR)
      CALL OK(IERR, 'FTDRHS')
      CALL SAME(W(2), -1D0, 'd of the second row')
      CALL SAME(W(3), -0.25D0, 'd of the equality row')
      CALL FTBFXS(IP, 2, 0, IDOF, IERR)
      CALL OK(IERR, 'FTBFXS')
      CALL FTPHSN(IP, N, IERR)
      CALL OK(IERR, 'FTPHSN')
      CALL HOLDS(N .GE. 8, 'FTPHSN')
      CALL FTPHAS(IP, N, NAME, SECS, B, IERR)
      CALL OK(IERR, 'FTPHAS')
      CALL HOLDS(NAME .EQ. 'recovery' .AND. SECS .GE. 0D0 .AND. B .GE.
     &  0D0, 'FTPHAS')
      END

C     Other gaps, compliance, rows cleared and added again.
      SUBROUTINE CHANGE(IP)
      INCLUDE 'feti_contact_f77.inc'
      INTEGER IP, IERR, NB, N, M, ME, I, IPTR(2), IDOF(1)
      DOUBLE PRECISION C(1), H(1), RHS(1)
      DATA IPTR / 1, 2 /, IDOF / 5 /, H / 1D0 /, RHS / 0.25D0 /
      C(1) = 0.2D0
      CALL FTRRHS(IP, FTKINE, 1, 1, C, IERR)
      CALL OK(IERR, 'FTRRHS')
      CALL SOLVES(IP, 10D0, -0.4D0, 'a wider gap')
      C(1) = 0.01D0
      CALL FTRCMP(IP, FTKINE, 1, 1, C, IERR)
      CALL OK(IERR, 'FTRCMP')
      CALL SOLVES(IP, 10D0, -0.5D0, 'a spring in the gap')
      C(1) = 0D0
      CALL FTRCMP(IP, FTKINE, 1, 1, C, IERR)
      CALL OK(IERR, 'FTRCMP')
      C(1) = 0.1D0
      CALL FTRRHS(IP, FTKINE, 1, 1, C, IERR)
      CALL OK(IERR, 'FTRRHS')
      CALL FTRCLR(IP, FTKEQU, IERR)
      CALL OK(IERR, 'FTRCLR')
      CALL FTCNTS(IP, NB, N, M, ME, IERR)
      CALL OK(IERR, 'FTCNTS')
      CALL HOLDS(M .EQ. 2 .AND. ME .EQ. 0, 'FTRCLR')
      CALL FTROWC(IP, FTKEQU, 1, IPTR, IDOF, H, RHS, I, IERR)
      CALL OK(IERR, 'FTROWC')
      CALL HOLDS(I .EQ. 1, 'rows count from 1 again')
      CALL SOLVES(IP, 10D0, -0.3D0, 'the rows of the beginning')
      END

C     Stiffer springs, a stiffer point, and those of the beginning.
      SUBROUTINE VALUES(IP)
      INCLUDE 'feti_contact_f77.inc'
      INTEGER IP, IERR
      DOUBLE PRECISION A(4), A3(1), RMU(1)
      DATA A / -2D2, 4D2, -2D2, 2D2 /, A3 / 8D0 /
      CALL FTBVAL(IP, 1, 4, A, IERR)
      CALL OK(IERR, 'FTBVAL')
      CALL FTBVDN(IP, 3, 1, A3, 1, IERR)
      CALL OK(IERR, 'FTBVDN')
      CALL SOLVES(IP, 10D0, -0.2D0, 'twice the stiffness')
      CALL FTMULT(IP, FTKEQU, 1, RMU, IERR)
      CALL OK(IERR, 'FTMULT')
      CALL SAME(RMU(1), -2D0, 'mu of a stiffer point')
      A(1) = -1D2
      A(2) = 2D2
      A(3) = -1D2
      A(4) = 1D2
      CALL FTBVAL(IP, 1, 3, A, IERR)
      CALL HOLDS(IERR .EQ. FTEARG - 3, 'three values of four')
      CALL FTBVAL(IP, 1, 4, A, IERR)
      CALL OK(IERR, 'FTBVAL')
      CALL SOLVES(IP, 10D0, -0.3D0, 'the stiffness of the beginning')
      END

C     A load step that is taken back; start values.
      SUBROUTINE STATES(IP)
      INCLUDE 'feti_contact_f77.inc'
      INTEGER IP, IERR, ID
      DOUBLE PRECISION F(2), RLAM(2)
      CALL FTSSAV(IP, ID, IERR)
      CALL OK(IERR, 'FTSSAV')
      CALL HOLDS(ID .EQ. 1, 'the first state is not number 1')
      F(1) = 0D0
      F(2) = -20D0
      CALL FTBLOD(IP, 2, 2, F, IERR)
      CALL OK(IERR, 'FTBLOD')
      CALL SOLVES(IP, 20D0, -0.5D0, 'twice the load')
      CALL FTSRES(IP, ID, IERR)
      CALL OK(IERR, 'FTSRES')
      CALL FTMULT(IP, FTKINE, 2, RLAM, IERR)
      CALL OK(IERR, 'FTMULT')
      CALL SAME(RLAM(1), 10D0, 'the force comes back')
      CALL FTSTRT(IP, FTKINE, 2, RLAM, IERR)
      CALL OK(IERR, 'FTSTRT')
      CALL SOLVES(IP, 10D0, -0.3D0, 'a start from the answer')
      CALL FTSDRP(IP, ID, IERR)
      CALL OK(IERR, 'FTSDRP')
      CALL FTSRES(IP, ID, IERR)
      CALL HOLDS(IERR .EQ. FTEARG - 2, 'a dropped state is restored')
      END
